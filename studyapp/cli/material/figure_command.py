"""`motionjury figure`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from renderer.figures.strip import MAX_MOMENTS, Moment
from studyapp.cli.arguments import study_folder
from studyapp.cli.output import progress
from studyapp.study.folder import StudyFolder

if TYPE_CHECKING:
    from studyapp.stimuli.figures.stills import Choice, Print

_OUTPUT = click.Path(dir_okay=False, path_type=Path)
_ENDINGS = (".pdf", ".png")


class _MomentType(click.ParamType[Moment]):
    name = "moment"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> Moment:
        return value if isinstance(value, Moment) else Moment.parse(str(value))


class _MotionType(click.ParamType[tuple[Path, str]]):
    """A motion file and what the figure calls it."""

    name = "motion"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Path, str]:
        if isinstance(value, tuple):
            return value
        path, called = Path(str(value)), ""
        if not path.is_file():
            name, _, called = str(value).rpartition("=")
            path = Path(name)
        if not path.is_file():
            self.fail(f"there is no file {str(value)!r}", param, ctx)
        return path, called.strip() or path.stem


segment = click.option("--segment", required=True, help="The segment that is shown.")
conditions = click.option(
    "--condition",
    "conditions",
    multiple=True,
    metavar="NAME[=CALLED]",
    help="A condition, as often as wanted, and what the figure calls it; without any, all but "
    "the catch motion.",
)
clear = click.option("--clear", is_flag=True, help="Leave the background transparent.")
whole = click.option("--whole", is_flag=True, help="Show whole frames, not what figures fill.")
closeup = click.option("--closeup", is_flag=True, help="Show the faces alone.")
skeleton = click.option(
    "--skeleton", type=click.Choice(["over", "beside"]), help="Draw the skeleton too."
)
output = click.option(
    "--output",
    type=_OUTPUT,
    help="Where to write it, instead of into FOLDER/figures.",
)


def moments(*, required: bool) -> Callable[..., Any]:
    """Return the option for the moments that a figure shows."""
    return click.option(
        "--at",
        "moments",
        type=_MomentType(),
        multiple=True,
        required=required,
        metavar="[WORD=]SECONDS",
        help="A moment of the segment, as often as wanted, and the key word spoken there.",
    )


def inches(default: float) -> Callable[..., Any]:
    """Return the option for the width of a printed figure."""
    return click.option(
        "--inches",
        type=click.FloatRange(1, 14),
        default=default,
        show_default=True,
        help="Width in print, at 300 dots per inch.",
    )


@click.group("figure")
def command() -> None:
    """Make a figure or video for the paper from a study.

    They name the conditions: what is written into FOLDER/figures is never served to participants.
    """


@command.command("still")
@study_folder
@segment
@click.option("--condition", required=True, help="The condition that is shown.")
@click.option("--at", "seconds", type=click.FloatRange(0), required=True, help="Seconds.")
@click.option("--size", type=click.IntRange(64, 2160), default=1440, show_default=True)
@skeleton
@clear
@closeup
@output
def still(folder: StudyFolder, output: Path | None, **choice: Any) -> None:
    """Write one frame of one condition as PNG."""
    from studyapp.stimuli.figures.stills import write_still

    name = f"still-{choice['segment']}-{choice['condition']}-{choice['seconds']:g}s.png"
    path = output or folder.figures / name
    write_still(folder, **choice, output=path)
    click.echo(f"The still is {path}")


@command.command("strip")
@study_folder
@segment
@conditions
@moments(required=False)
@click.option(
    "--moments",
    "count",
    type=click.IntRange(1, MAX_MOMENTS),
    default=6,
    show_default=True,
    help="Without --at: how many moments, the loudest syllable of each part of the speech.",
)
@inches(6.9)
@click.option("--wave/--no-wave", default=True, help="Draw the speech's wave under it.")
@clear
@whole
@closeup
@click.option("--skeleton", is_flag=True, help="Draw the skeleton over the body.")
@output
def strip(
    folder: StudyFolder,
    output: Path | None,
    count: int,
    wave: bool,
    skeleton: bool,
    **options: Any,
) -> None:
    """Write a strip: a row for each condition, a column for each key word."""
    from studyapp.stimuli.figures.stills import write_strip

    choice, printed = _split(folder, "strip", output, options)
    write_strip(folder, choice, printed, count=count, wave=wave, skeleton=skeleton)
    click.echo(f"The strip is {' and '.join(map(str, printed.outputs))}")


@command.command("overlay")
@study_folder
@segment
@conditions
@click.option(
    "--motion",
    "motions",
    type=_MotionType(),
    multiple=True,
    metavar="FILE[=CALLED]",
    help="A motion file for the segment's speech, such as another seed, as often as wanted, and "
    "what the figure calls it; without --condition, these alone.",
)
@moments(required=True)
@inches(3.3)
@clear
@whole
@closeup
@output
def overlay(
    folder: StudyFolder, output: Path | None, motions: tuple[tuple[Path, str], ...], **options: Any
) -> None:
    """Write several moments or variations over each other in one picture.

    Several moments make a trail, older ones fainter; several conditions or motion files are
    tinted, each in a colour of its own.
    """
    from studyapp.stimuli.figures.stills import write_overlay

    choice, printed = _split(folder, "overlay", output, options)
    write_overlay(folder, choice, printed, motions=motions)
    click.echo(f"The overlay is {' and '.join(map(str, printed.outputs))}")


@command.command("grid")
@study_folder
@segment
@conditions
@click.option(
    "--slow",
    "speed",
    type=click.FloatRange(0.1, 1),
    default=1.0,
    metavar="SPEED",
    help="Slow motion without sound, such as 0.25 for quarter speed.",
)
@skeleton
@click.option("--size", type=click.IntRange(64, 2160), help="Pixels along each side of a panel.")
@closeup
@output
def grid(folder: StudyFolder, output: Path | None, **options: Any) -> None:
    """Write a video of several conditions side by side, each with its name."""
    from studyapp.stimuli.figures.grids import write_grid_of

    slow = "" if options["speed"] == 1 else f"-slow{options['speed']:g}"
    path = output or folder.figures / f"grid-{options['segment']}{slow}.mp4"
    with progress("grid", "frame") as show:
        write_grid_of(folder, **options, output=path, on_frame=show)
    click.echo(f"The video is {path}")


def _split(
    folder: StudyFolder, kind: str, output: Path | None, options: dict[str, Any]
) -> tuple[Choice, Print]:
    """Return what a figure shows and how it is printed."""
    from studyapp.stimuli.figures.stills import Choice, Print

    outputs = (
        (output,)
        if output
        else tuple(folder.figures / f"{kind}-{options['segment']}{ending}" for ending in _ENDINGS)
    )
    names = ("inches", "clear", "whole", "closeup")
    printed = Print(**{name: options.pop(name) for name in names}, outputs=outputs)
    return Choice(**options), printed
