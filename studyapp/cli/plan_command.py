"""`motionjury plan`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from studyapp.cli.arguments import processes, study_folder
from studyapp.cli.output import progress
from studyapp.study.folder import StudyFolder


class _Several(click.ParamType[tuple[Any, ...]]):
    """Numbers with commas between."""

    name = "numbers"

    def __init__(self, each: click.ParamType[Any]) -> None:
        self._each = each

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Any, ...]:
        if isinstance(value, tuple):
            return value
        return tuple(self._each.convert(text, param, ctx) for text in str(value).split(","))


@click.command("plan")
@study_folder
@click.option(
    "--participants",
    type=_Several(click.IntRange(1, 100_000)),
    default=(),
    metavar="N,…",
    help="How many are tried: of each comparison where it has participants of its own, else of "
    "the study.  [default: 1, 2, 4 and 8 times the study's]",
)
@click.option(
    "--items",
    type=_Several(click.IntRange(1, 10_000)),
    default=(),
    metavar="N,…",
    help="How many segments are tried.  [default: as many as the study has, and twice as many]",
)
@click.option(
    "--effect",
    "effects",
    type=_Several(click.FloatRange(0, 10)),
    default=(0.2, 0.4, 0.6),
    metavar="X,…",
    help="Differences between conditions that are tried, in logits.  [default: 0.2,0.4,0.6]",
)
@click.option(
    "--pilot",
    type=click.Path(exists=True, path_type=Path),
    help="A study folder that was answered, or a table of answers as 'motionjury report "
    "--responses' takes it: spreads and exclusions are estimated from it.",
)
@click.option(
    "--pay",
    type=click.FloatRange(0, min_open=True),
    metavar="AMOUNT",
    help="What one participant costs, fees included; designs then say what they cost.",
)
@processes
def command(folder: StudyFolder, processes: int, **options: Any) -> None:
    """Say how many participants and segments a study needs, by simulating it.

    The study in FOLDER is drawn up in several sizes; simulated people answer it; its report's own
    tests decide. Without speech yet, --items says how many segments it will have.
    """
    # Imported here: statistics take seconds to load, which --help need not wait for.
    from analysis.planning.words import plan_sentences
    from analysis.planning.writing import power_lines
    from studyapp.planning.plan import plan_study

    with progress("simulating", "cell") as show:
        found = plan_study(folder, **options, processes=processes, show=show)
    where = folder.root / "plan"
    click.echo("\n".join((*power_lines(found), "", *plan_sentences(found), "")))
    click.echo(f"The figure is {where / 'power.png'}, the numbers are {where / 'power.csv'}")
