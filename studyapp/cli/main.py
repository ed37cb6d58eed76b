"""`motionjury`, and how its subcommands are found and their errors shown."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EDQUOT, ENOSPC
from importlib import import_module, metadata
from typing import Any, Final

import click

from motion.errors import InputError
from studyapp.side_process import collect_garbage_seldom

_COMMANDS: Final = {
    "backup": ("backup", "Back up a study into one file, or check a backup."),
    "check": ("check", "Check a study before its launch."),
    "corpus": (
        "generate:corpus",
        "Make a synthetic corpus of speech and motion to train and test on.",
    ),
    "demo": ("demo", "Run a whole study on synthetic speech, up to its report."),
    "desk": ("serve:desk", "Serve all studies of a lab, to create and watch them in the browser."),
    "deploy": ("serve:deploy", "Write the files that a public server needs."),
    "exclude": ("exclude", "Exclude a participant from the analysis, or reinstate one."),
    "export": ("export", "Export the answers as tables, or as a folder for another lab."),
    "figure": ("figure", "Make figures and videos for a paper."),
    "forget": ("exclude:forget", "Erase a participant."),
    "generate": ("generate", "Generate the motion of all generated conditions."),
    "import": ("import", "Import speech, motion and finished videos."),
    "init": ("init", "Create a study folder with a commented study.toml."),
    "metrics": ("metrics", "Compute automatic metrics of a study or of motion files."),
    "plan": ("plan", "Find how many participants and segments a study needs."),
    "preview": ("render:preview", "Show motion files, or convert them."),
    "publish-media": ("render:publish_media", "Upload the videos to an S3-compatible store."),
    "recruit": ("recruit", "Recruit participants, and pay them."),
    "rehearse": ("plan:rehearse", "Let simulated participants take the study over real HTTP."),
    "render": ("render", "Render the videos of a study."),
    "report": ("report", "Write the report."),
    "researchers": ("researchers", "Manage access to the researchers' pages."),
    "restore": ("backup:restore", "Restore a study from a backup."),
    "serve": ("serve", "Serve the study to participants."),
    "train": ("train", "Train networks on your own recordings."),
}
"""Module and summary of each; ``module:NAME`` is `NAME_command` there, others are `command`."""

_MOTION_PACKAGES: Final = {
    "OpenGL",
    "accelerate",
    "pyrender",
    "safetensors",
    "torch",
    "transformers",
}
"""Packages of the extra `motion`."""


class LazyGroup(click.Group):
    """A group that lists its subcommands without importing them."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the subcommand; an error suggests the nearest of those listed."""
        try:
            return super().resolve_command(ctx, args)
        except click.NoSuchCommand as error:
            names = self.list_commands(ctx)
            raise click.NoSuchCommand(args[0], possibilities=names, ctx=ctx) from error


class _LazyCommands(LazyGroup):
    """Imports a subcommand only when it is run, so that each starts fast."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _COMMANDS:
            return None
        module_name, _, name = _COMMANDS[cmd_name][0].partition(":")
        module = import_module(f"studyapp.cli.{module_name}_command")
        command: click.Command = getattr(module, f"{name}_command" if name else "command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(
                [(name, summary) for name, (_, summary) in sorted(_COMMANDS.items())]
            )

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except ModuleNotFoundError as error:
            missing = str(error.name).partition(".")[0]
            if ctx.params["debug"] or missing not in _MOTION_PACKAGES:
                raise
            raise click.ClickException(
                f"This command needs {missing}, which is not installed. Networks and rendering are "
                "an extra; install it with: pip install 'motionjury[motion]'"
            ) from error
        except InputError as error:
            if ctx.params["debug"]:
                raise
            raise click.ClickException(str(error)) from error
        except OSError as error:
            # A reader such as 'head' may close the pipe: click then ends the command quietly.
            if ctx.params["debug"] or isinstance(error, BrokenPipeError):
                raise
            raise click.ClickException(_explain(error)) from error


def _explain(error: OSError) -> str:
    where = f"{error.filename}: " if error.filename else ""
    remedy = (
        "Free up space, and run the same command again."
        if error.errno in (ENOSPC, EDQUOT)
        else "Check the path, and that it is readable and writable."
    )
    return f"{where}{error.strerror or error}. {remedy}"


_SETTINGS: Final = {"help_option_names": ["-h", "--help"], "show_default": True}


@click.group(cls=_LazyCommands, context_settings=_SETTINGS)
@click.version_option(metadata.version("motionjury"), prog_name="motionjury")
@click.option("--debug", is_flag=True, help="Show a traceback when something fails.")
def group(debug: bool) -> None:
    """Find out which generated motion people prefer, and whether the metrics agree."""


@contextmanager
def _every_interruption() -> Iterator[None]:
    """Interrupt again where Python only prints the exception, as in a weak reference's callback."""
    print_exception, thread = sys.unraisablehook, threading.get_ident()

    def interrupt_again(unraisable: sys.UnraisableHookArgs) -> None:
        if unraisable.exc_type is KeyboardInterrupt:
            again = threading.Timer(0.1, signal.pthread_kill, (thread, signal.SIGINT))
            again.daemon = True
            again.start()
        else:
            print_exception(unraisable)

    sys.unraisablehook = interrupt_again
    try:
        yield
    finally:
        sys.unraisablehook = print_exception


def main() -> None:
    """Run the command line; an interruption says how to continue."""
    collect_garbage_seldom()
    # Ended like this, a command stops what it has started, as it does at Ctrl-C.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with _every_interruption():
            group(standalone_mode=False, prog_name="motionjury")
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        click.echo("\nInterrupted. Run the same command again to continue.", err=True)
        sys.exit(130)
    except click.exceptions.Exit as error:
        sys.exit(error.exit_code)


if __name__ == "__main__":
    main()
