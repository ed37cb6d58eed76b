"""Arguments that several subcommands share."""

import math
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any, Final, get_args
from urllib.parse import urlsplit

import click
from click.core import ParameterSource

from generators.registry import Device
from motion.errors import InputError
from studyapp.desk.jobs import PROCESSES
from studyapp.side_process import MOST_PROCESSES, available_processors
from studyapp.study.folder import StudyFolder

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def together(*options: Decorator) -> Decorator:
    """Return several options of a command as one decorator."""

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


def existing_study(root: str | Path) -> StudyFolder:
    """Return the study folder at `root`; raise `InputError` if it is none."""
    folder = StudyFolder(Path(root))
    if not folder.definition.exists():
        raise InputError(
            "this is not a study folder: study.toml is missing",
            where=folder.root,
            remedy="Check the path, or create a study with 'motionjury init'",
        )
    return folder


def current_study() -> StudyFolder | None:
    """Return the study in the working directory; None if there is none."""
    folder = StudyFolder(Path())
    return folder if folder.definition.exists() else None


def given_options() -> list[str]:
    """Return the options that were typed for the running command, as its help names them."""
    context = click.get_current_context()
    return [
        param.opts[0]
        for param in context.command.get_params(context)
        if isinstance(param, click.Option)
        and context.get_parameter_source(str(param.name)) is ParameterSource.COMMANDLINE
    ]


def refuse_options(options: Collection[str], context: str) -> None:
    """Raise `InputError` if any of the options is given together with `context`."""
    if refused := [name for name in given_options() if name in options]:
        raise InputError(
            f"{', '.join(refused)} cannot be given with {context}", remedy="Omit one or the other"
        )


class StudyGroup(click.Group):
    """A group of a study: within its folder, the folder may be left out."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Take a subcommand's name for what it is, not for a folder; its help needs no study."""
        if args[:1] and args[0] in self.commands:
            args = [".", *args]
        ctx.resilient_parsing = not {*args[2:]}.isdisjoint(ctx.help_option_names)
        rest = super().parse_args(ctx, args)
        ctx.resilient_parsing = False
        return rest

    def subcommand(self, name: str) -> Callable[[Callable[..., None]], click.Command]:
        """Return the decorator of a subcommand, which gets the study folder."""
        return lambda function: self.command(name)(click.pass_obj(function))


class StudyCommand(click.Command):
    """A command of a study and one thing more: within its folder, the folder may be left out."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put the working directory first where it is the study and only the other is given."""
        names = [p.name for p in self.params if isinstance(p, click.Argument)]
        values, _, _ = self.make_parser(ctx).parse_args([*args])
        first, *others = (values.get(str(name)) for name in names)
        is_alone = isinstance(first, str) and not any(isinstance(each, str) for each in others)
        if is_alone and current_study() and not StudyFolder(Path(str(first))).definition.exists():
            args = [".", *args]
        return super().parse_args(ctx, args)


FILE: Final = click.Path(dir_okay=False, path_type=Path)
EXISTING_FILE: Final = click.Path(exists=True, dir_okay=False, path_type=Path)
FOLDER: Final = click.Path(file_okay=False, path_type=Path)


class Number(click.FloatRange):
    """A number within bounds; click itself lets NaN pass them."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the number, or fail with click's error."""
        number: float = super().convert(value, param, ctx)
        return number if math.isfinite(number) else self.fail(f"{value!r} is not a number.")


def _read_joint_map(path: str) -> Mapping[str, str]:
    # Imported here: most commands read no motion.
    from motion.formats.joint_maps import read_joint_map

    return read_joint_map(Path(path))


file_rate_option = click.option(
    "--fps",
    "frame_rate",
    type=Number(0, 1000, min_open=True),
    help="Frame rate, overriding the files' own.",
)
joints_option = click.option(
    "--joints",
    "joint_map",
    type=_read_joint_map,
    metavar="FILE",
    help="A file that maps the joints of another skeleton (BVH or joint positions), in lines such "
    'as pelvis = "Hips".',
)

study_folder = click.argument("folder", type=existing_study, default=".")
"""An existing study folder; by default the working directory."""

optional_study_folder: Decorator = click.argument("folder", required=False, type=existing_study)
"""An existing study folder, or none."""

processes_option: Decorator = click.option(
    "--processes",
    type=click.IntRange(1, MOST_PROCESSES),
    envvar=PROCESSES,
    default=available_processors,
    show_default="one per processor",
    help="Number of parallel processes.",
)

device_option = click.option(
    "--device", type=click.Choice(get_args(Device)), default="cpu", help="Where networks run."
)


def public_address(*, help: str, default: str | None = None, required: bool = False) -> Decorator:
    """Return the option of the public address, which the command gets without a final slash.

    It is empty if not given.
    """
    return click.option(
        "--address",
        default=default,
        required=required,
        metavar="URL",
        envvar="MOTIONJURY_ADDRESS",
        callback=lambda context, parameter, value: (
            check_address(value) if value or required else ""
        ),
        help=help,
    )


def check_address(address: str) -> str:
    """Return a public address without a final slash; `InputError` if it is none."""
    parts = urlsplit(address)
    has_host = parts.scheme in ("http", "https") and parts.hostname
    if not has_host or parts.query or parts.fragment:
        raise InputError(
            "this is not the address of a study",
            where=f"address {address!r}",
            remedy="Give one such as https://study.example.org/",
        )
    return address.rstrip("/")
