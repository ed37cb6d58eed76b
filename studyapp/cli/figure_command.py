"""`motionjury figure`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from renderer.figures.strip import MAX_MOMENTS, Moment
from studyapp.cli.arguments import FILE, Number, study_folder
from studyapp.cli.output import progress
from studyapp.study.folder import StudyFolder

if TYPE_CHECKING:
    from studyapp.stimuli.figures.paper_figures import PaperFigure

_ENDINGS = (".pdf", ".png")


segment = click.option("--segment", required=True, help="The segment to show.")
conditions = click.option(
    "--condition",
    "conditions",
    multiple=True,
    metavar="NAME[=LABEL]",
    help="A condition and its label; can be repeated.  [default: all but the catch condition]",
)
clear = click.option("--clear", is_flag=True, help="Make the background transparent.")
closeup = click.option("--closeup", is_flag=True, help="Show only the faces.")
output = click.option(
    "--output", type=FILE, help="The output file, instead of one in FOLDER/figures."
)


def moments(*, required: bool) -> Callable[..., Any]:
    """Return the option of a figure's moments."""
    return click.option(
        "--at",
        "moments",
        type=Moment.parse,
        multiple=True,
        required=required,
        metavar="[WORD=]SECONDS",
        help="A moment of the segment and the key word spoken there; can be repeated.",
    )


def inches(default: float) -> Callable[..., Any]:
    """Return the option of a figure's printed width."""
    return click.option(
        "--inches",
        type=Number(1, 14),
        default=default,
        help="Width in print, at 300 dots per inch.",
    )


@click.group("figure")
def command() -> None:
    """Make a figure or a video of a study for a paper.

    Figures name the conditions; files in FOLDER/figures are never served to participants.
    """


@command.command("still")
@study_folder
@segment
@click.option("--condition", required=True, help="The condition to show.")
@click.option("--at", "seconds", type=Number(0), required=True, help="The moment.")
@click.option("--size", type=click.IntRange(64, 2160), default=1440)
@clear
@closeup
@output
def still(folder: StudyFolder, output: Path | None, **choice: Any) -> None:
    """Write one frame of a condition as PNG."""
    from studyapp.stimuli.figures.paper_figures import write_still

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
    help="Without --at: number of moments, each at the loudest syllable of a part of the speech.",
)
@inches(6.9)
@click.option("--wave/--no-wave", default=True, help="Draw the waveform of the speech below.")
@clear
@closeup
@output
def strip(
    folder: StudyFolder,
    output: Path | None,
    count: int,
    wave: bool,
    **options: Any,
) -> None:
    """Write a strip with a row per condition and a column per key word."""
    from studyapp.stimuli.figures.paper_figures import write_strip

    figure = _figure(folder, "strip", output, options)
    write_strip(figure, count=count, wave=wave)
    click.echo(f"The strip is {' and '.join(map(str, figure.outputs))}")


@command.command("overlay")
@study_folder
@segment
@conditions
@moments(required=True)
@inches(3.3)
@clear
@closeup
@output
def overlay(folder: StudyFolder, output: Path | None, **options: Any) -> None:
    """Write a picture of several moments or conditions on top of each other.

    Several moments make a trail that fades with age; several conditions are tinted in different
    colours.
    """
    from studyapp.stimuli.figures.paper_figures import write_overlay

    figure = _figure(folder, "overlay", output, options)
    write_overlay(figure)
    click.echo(f"The overlay is {' and '.join(map(str, figure.outputs))}")


@command.command("grid")
@study_folder
@segment
@conditions
@closeup
@output
def grid(folder: StudyFolder, output: Path | None, **options: Any) -> None:
    """Write a video of several conditions side by side, with their names."""
    from studyapp.stimuli.figures.paper_figures import write_condition_grid

    path = output or folder.figures / f"grid-{options['segment']}.mp4"
    with progress("grid", "frame") as show:
        write_condition_grid(folder, **options, output=path, on_frame=show)
    click.echo(f"The video is {path}")


def _figure(
    folder: StudyFolder, kind: str, output: Path | None, options: dict[str, Any]
) -> PaperFigure:
    from studyapp.stimuli.figures.paper_figures import PaperFigure

    name = f"{kind}-{options['segment']}"
    outputs = (output,) if output else tuple(folder.figures / f"{name}{end}" for end in _ENDINGS)
    return PaperFigure(folder=folder, outputs=outputs, **options)
