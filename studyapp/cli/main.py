"""`motionjury`: the front door."""

from __future__ import annotations

import sys
from difflib import get_close_matches
from importlib import import_module, metadata
from typing import Any, Final

import click

from motion.errors import InputError

_COMMANDS: Final = {
    "backup": ("backup", "Back up a study into one file, or check a backup."),
    "check": ("check", "Say everything that can go wrong before launch."),
    "corpus": ("material.corpus", "Make speech and motion with known truth, to train and test on."),
    "demo": ("demo", "Run the whole line on synthetic speech, from nothing to a report."),
    "desk": ("desk", "Serve all studies of a lab, which are made and watched in the browser."),
    "deploy": (
        "serve:deploy",
        "Write the files with which a server serves the study to the world.",
    ),
    "exclude": ("exclude", "Leave a participant out of the analysis, or take one in again."),
    "export": ("export", "Write the answers as tables, or as a folder for another lab."),
    "figure": ("material.figure", "Make figures and videos for the paper."),
    "forget": ("exclude:forget", "Erase a participant."),
    "generate": ("material.generate", "Make the motion of every generated condition."),
    "import": ("material.import", "Bring speech, recordings and others' motion into a study."),
    "init": ("init", "Make a study folder with a commented study.toml."),
    "metrics": ("metrics", "Compute automatic metrics of a study, or of folders of motion files."),
    "plan": ("plan", "Say how many participants and segments a study needs."),
    "preview": (
        "material.render:preview",
        "Look at any motion file: a video and a sheet of frames.",
    ),
    "publish-media": ("publish_media", "Bring the videos into an S3-compatible store."),
    "recruit": ("recruit", "Bring participants to the study, and pay them."),
    "rehearse": ("rehearse", "Let simulated participants take the study over real HTTP."),
    "render": ("material.render", "Render clips and side-by-side pairs."),
    "report": ("report", "Write the report."),
    "researchers": ("researchers", "Say who may see the study's pages, and let people in."),
    "restore": ("backup:restore", "Bring a study back from a backup."),
    "serve": ("serve", "Serve the study to participants."),
    "train": ("material.train", "Train networks on your own recordings."),
}
"""What each does, and its module; ``module:NAME`` is `NAME_command` there, others are `command`."""

_MOTION_PACKAGES: Final = {
    "OpenGL",
    "accelerate",
    "pyrender",
    "safetensors",
    "torch",
    "transformers",
}
"""Modules of the extra `motion`."""


class _LazyCommands(click.Group):
    """Imports a subcommand only when it is run, so that each one starts fast."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _COMMANDS:
            return None
        home, _, other = _COMMANDS[cmd_name][0].partition(":")
        module = import_module(f"studyapp.cli.{home}_command")
        command: click.Command = getattr(module, f"{other}_command" if other else "command")
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        near = get_close_matches(args[0], _COMMANDS, n=1)
        if near and args[0] not in _COMMANDS:
            ctx.fail(f"No such command {args[0]!r}. Did you mean {near[0]!r}?")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, told) for name, (_, told) in sorted(_COMMANDS.items())])

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except ModuleNotFoundError as error:
            missing = str(error.name).partition(".")[0]
            if ctx.params["debug"] or missing not in _MOTION_PACKAGES:
                raise
            raise click.ClickException(
                f"This command needs {missing}, which is not installed: networks and rendering "
                "are an extra. Install it with: pip install 'motionjury[motion]'"
            ) from error
        except InputError as error:
            if ctx.params["debug"]:
                raise
            raise click.ClickException(str(error)) from error
        except OSError as error:
            if ctx.params["debug"] or error.filename is None:
                raise
            raise click.ClickException(
                f"{error.filename}: {error.strerror}. Check that this is the right path, and that "
                "it may be read and written."
            ) from error


@click.group(cls=_LazyCommands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(metadata.version("motionjury"), prog_name="motionjury")
@click.option("--debug", is_flag=True, help="Show a traceback when something fails.")
def group(debug: bool) -> None:
    """Find out which generated motion people prefer, and whether the metrics agree."""


def main() -> None:
    """Run the command line; an interruption says how to go on."""
    try:
        group(standalone_mode=False, prog_name="motionjury")
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        click.echo("\nInterrupted. The same command goes on where it stopped.", err=True)
        sys.exit(130)
    except click.exceptions.Exit as leaving:
        sys.exit(leaving.exit_code)


if __name__ == "__main__":
    main()
