"""`motionjury plan`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import click

from motion.errors import InputError
from studyapp.cli.arguments import optional_study_folder, processes, refuse_beside
from studyapp.cli.output import progress
from studyapp.study.folder import StudyFolder

PROTOCOLS: Final = ("pairwise", "rating", "ranking", "mismatch")


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
@optional_study_folder
@click.option("--protocol", type=click.Choice(PROTOCOLS), help="Without FOLDER: the protocol.")
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
    "--trials",
    type=click.IntRange(0, 500),
    metavar="N",
    help="Trials of each participant, of each part of a study; 0 for all segments.  [default: as "
    "the study says; without a study, all segments]",
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
@click.option(
    "--test",
    type=click.Choice(["report", "crossed_lmm"]),
    default="report",
    show_default=True,
    help="What decides: what the study's report decides by, or a crossed linear mixed model of "
    "scores (participants and segments as random effects; pairs where everybody judges all).",
)
@click.option(
    "--precision",
    type=click.FloatRange(0.002, 0.1),
    help="Monte-Carlo standard error of each power, however long it takes.  [default: 0.02, or "
    "what two minutes on two processors allow]",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="The folder that gets plan.json, power.csv and power.png, .svg and .pdf.  [default: "
    "FOLDER/plan, or 'plan' here]",
)
@processes
def command(
    folder: StudyFolder | None,
    protocol: str | None,
    out: Path | None,
    processes: int,
    **options: Any,
) -> None:
    """Say how many participants and segments a study needs, by simulating it.

    The study in FOLDER is drawn up in several sizes; simulated people answer it; its report's own
    tests decide. Without FOLDER, a study of one comparison (pairwise), of three conditions (rating,
    ranking) or of one (mismatch), which asks one question of all segments, is planned:

    motionjury plan --protocol pairwise --participants 25,50,100 --items 24,48 --effect .2,.4
    """
    # Imported here: statistics take seconds to load, which --help need not wait for.
    from analysis.planning.words import sentences
    from analysis.planning.writing import lines
    from studyapp.planning.plan import Options, plan_sketch, plan_study

    asked = Options(**options)
    where = out or (folder.root / "plan" if folder is not None else Path("plan"))
    if folder is not None:
        refuse_beside({"--protocol": protocol}, "a study folder, which says it itself")
    with progress("simulating", "cell") as show:
        if folder is not None:
            found = plan_study(folder, asked, where, processes=processes, show=show)
        else:
            named = _complete(protocol, options)
            found = plan_sketch(named, asked, where, processes=processes, show=show)
    click.echo("\n".join((*lines(found), "", *sentences(found), "")))
    click.echo(f"The figure is {where / 'power.png'}, the numbers are {where / 'power.csv'}")


def _complete(protocol: str | None, options: Mapping[str, Any]) -> str:
    """Return the protocol; `InputError` where something that a study would say is missing."""
    missing = [f"--{name}" for name in ("participants", "items") if not options[name]]
    if protocol is not None and not missing:
        return protocol
    if protocol is None and len(missing) == 2:
        raise InputError(
            "there is nothing to plan",
            remedy="Name a study folder, or say what study it is: --protocol pairwise "
            "--participants 25,50,100 --items 24,48",
        )
    raise InputError(
        f"{', '.join([*([] if protocol else ['--protocol']), *missing])} is missing for a plan "
        "without a study folder",
        remedy="Give --protocol, --participants and --items",
    )
