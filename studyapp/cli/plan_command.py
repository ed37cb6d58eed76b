"""`motionjury plan`."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import click

from motion.errors import InputError
from studyapp.cli.arguments import optional_study_folder, processes
from studyapp.cli.progress import progress
from studyapp.study.folder import StudyFolder

PROTOCOLS: Final = ("pairwise", "rating", "ranking", "mismatch")


class _Numbers(click.ParamType[tuple[float, ...]]):
    """Numbers with commas between them, such as ``25,50,100``."""

    name = "numbers"

    def __init__(self, least: float, most: float, *, whole: bool) -> None:
        self._least, self._most, self._whole = least, most, whole

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        if isinstance(value, tuple):
            return value
        kind = "whole numbers" if self._whole else "numbers"
        found = []
        for text in str(value).split(","):
            try:
                number = int(text) if self._whole else float(text)
            except ValueError:
                self.fail(f"{text.strip()!r} is none of {kind} with commas between.", param, ctx)
            if not self._least <= number <= self._most:
                self.fail(f"{number:g} is not from {self._least:g} to {self._most:g}.", param, ctx)
            found.append(number)
        return tuple(found)


class _Trials(click.ParamType[int]):
    """A number of trials, or ``all``."""

    name = "number"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> int:
        if isinstance(value, int):
            return value
        if value == "all":
            return 0
        if not str(value).isdecimal() or not 1 <= int(str(value)) <= 500:
            self.fail(f"{value!r} is no number of trials from 1 to 500, nor 'all'.", param, ctx)
        return int(str(value))


_SHARE: Final = click.FloatRange(0, 1, max_open=True)
_SPREAD: Final = click.FloatRange(0, 5)


@click.command("plan")
@optional_study_folder
@click.option("--protocol", type=click.Choice(PROTOCOLS), help="Without FOLDER: the protocol.")
@click.option(
    "--participants",
    type=_Numbers(1, 100_000, whole=True),
    metavar="N,…",
    help="How many are tried: of each comparison where it has participants of its own, else of "
    "the study.  [default: 1, 2, 4 and 8 times the study's]",
)
@click.option(
    "--items",
    type=_Numbers(1, 10_000, whole=True),
    metavar="N,…",
    help="How many segments are tried.  [default: as many as the study has, and twice as many]",
)
@click.option(
    "--effect",
    "effects",
    type=_Numbers(0, 10, whole=False),
    metavar="X,…",
    help="Differences between conditions that are tried, in logits.  [default: 0.2,0.4,0.6]",
)
@click.option(
    "--trials",
    type=_Trials(),
    metavar="N|all",
    help="Trials of each participant, of each part of a study.  [default: as the study says; "
    "without a study, all segments]",
)
@click.option(
    "--conditions",
    type=click.IntRange(1, 8),
    help="Without FOLDER: how many conditions a rating or ranking shows together (3 unless told "
    "otherwise), or a mismatch study has (1).",
)
@click.option(
    "--comparisons",
    type=click.IntRange(1, 100),
    help="Without FOLDER: how many comparisons a pairwise study has, each with participants of "
    "its own (1).",
)
@click.option(
    "--questions", type=click.IntRange(1, 8), help="Without FOLDER: how many questions (1)."
)
@click.option(
    "--spread-participants",
    "participant_sd",
    type=_SPREAD,
    help="Standard deviation between participants of the difference of two conditions, in "
    "logits.  [default: 0.6]",
)
@click.option(
    "--spread-segments",
    "item_sd",
    type=_SPREAD,
    help="The same between segments.  [default: 0.45]",
)
@click.option(
    "--excluded",
    type=_SHARE,
    metavar="SHARE",
    help="Share of participants whom rules will leave out.  [default: 0.1 of a study, 0 where it "
    "replaces them, and without a study]",
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
    default=0.02,
    show_default=True,
    help="Monte-Carlo standard error of each power.",
)
@click.option(
    "--minutes",
    type=click.FloatRange(0.1, 10_000),
    default=2,
    show_default=True,
    help="About how long it may take on two processors; less is simulated where it would take "
    "longer, which is said.",
)
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=1, show_default=True)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="The folder that gets plan.json, power.csv and power.png, .svg and .pdf.  [default: "
    "FOLDER/plan, or 'plan' here]",
)
@processes
def command(folder: StudyFolder | None, out: Path | None, processes: int, **options: Any) -> None:
    """Say how many participants and segments a study needs, by simulating it.

    The study in FOLDER is drawn up in several sizes; simulated people answer it; its report's own
    tests decide. Without FOLDER, say what study it is:

    motionjury plan --protocol pairwise --participants 25,50,100 --items 24,48 --effect .2,.4
    """
    from analysis.planning.words import sentences
    from analysis.planning.writing import lines
    from studyapp.planning.plan import Options, plan_sketch, plan_study

    sketched = {
        name: options.pop(name) for name in ("protocol", "conditions", "comparisons", "questions")
    }
    _require_fitting(folder, sketched, options)
    asked = Options(**{name: value for name, value in options.items() if value is not None})
    where = out or (folder.root / "plan" if folder is not None else Path("plan"))
    with progress("simulating", "cell") as show:
        if folder is not None:
            found = plan_study(folder, asked, where, processes=processes, show=show)
        else:
            sketch = _sketch(**sketched)
            found = plan_sketch(
                sketched["protocol"], sketch, asked, where, processes=processes, show=show
            )
    click.echo("\n".join(lines(found)))
    click.echo()
    click.echo("\n".join(sentences(found)))
    click.echo()
    click.echo(f"The figure is {where / 'power.png'}, the numbers are {where / 'power.csv'}")


def _require_fitting(
    folder: StudyFolder | None, sketched: dict[str, Any], options: dict[str, Any]
) -> None:
    """Refuse options that do not go together."""
    if folder is not None:
        given = [f"--{name}" for name, value in sketched.items() if value is not None]
        if given:
            raise InputError(
                f"{', '.join(given)} cannot be given with a study folder, which says all that "
                "itself",
                remedy="Leave out either the folder or the options",
            )
        return
    needed = {"--protocol": sketched["protocol"]}
    needed |= {f"--{name}": options[name] for name in ("participants", "items")}
    missing = [name for name, value in needed.items() if value is None]
    if len(missing) == len(needed):
        raise InputError(
            "there is nothing to plan",
            remedy="Name a study folder, or say what study it is: --protocol pairwise "
            "--participants 25,50,100 --items 24,48",
        )
    if missing:
        raise InputError(
            f"{', '.join(missing)} is missing for a plan without a study folder",
            remedy="Give --protocol, --participants and --items",
        )


def _sketch(
    protocol: str, conditions: int | None, comparisons: int | None, questions: int | None
) -> Any:
    from analysis.planning.size import Sketch

    wrong = "--conditions" if protocol == "pairwise" and conditions else ""
    wrong = "--comparisons" if protocol != "pairwise" and comparisons else wrong
    if wrong:
        raise InputError(
            f"{wrong} has no meaning for a {protocol} study",
            remedy="A pairwise study has --comparisons, all others have --conditions",
        )
    if protocol == "pairwise":
        return Sketch(
            kind="pairs",
            comparisons=comparisons or 1,
            own_participants=True,
            questions=questions or 1,
        )
    if protocol == "mismatch":
        return Sketch(kind="pairs", comparisons=conditions or 1, questions=questions or 1, levels=3)
    if conditions == 1:
        raise InputError(
            f"a {protocol} study of one condition compares nothing", remedy="Give --conditions 2"
        )
    return Sketch(
        kind="ratings" if protocol == "rating" else "rankings",
        conditions=conditions or 3,
        questions=questions or 1,
    )
