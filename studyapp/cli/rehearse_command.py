"""`motionjury rehearse`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click
from pydantic import ValidationError

from motion.errors import InputError
from studyapp.cli.arguments import study_folder
from studyapp.cli.output import progress
from studyapp.rehearsal.run import SPEED, WORKERS, RehearsalResult, rehearse
from studyapp.rehearsal.simulation.population import default_population
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.rehearsal import EVERY_QUESTION, SHARES, Rehearsal
from studyapp.study.settings.sections import explain
from studyapp.study.settings.study import Study

SHARE_REMEDY = f"Write KIND=SHARE, with one of {', '.join(SHARES)} and a number from 0 to 1"
STRENGTH_REMEDY = "Write CONDITION=LOGITS, or CONDITION:QUESTION=LOGITS for one question"


@click.command("rehearse")
@study_folder
@click.option(
    "--participants",
    type=click.IntRange(1, 10_000),
    help="Simulated participants, of each comparison where each has its own; as many as the "
    "study asks for by default.",
)
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=1, show_default=True)
@click.option(
    "--share",
    "shares",
    multiple=True,
    metavar="KIND=SHARE",
    help="Share of one kind of participant instead of that in study.toml, such as careless=0.2; "
    "docs/rehearsal.md lists the kinds. Can be repeated.",
)
@click.option(
    "--strength",
    "strengths",
    multiple=True,
    metavar="CONDITION[:QUESTION]=LOGITS",
    help="How good a condition really is, instead of what study.toml states, such as static=-1 or "
    "static:emotion=-0.5. Can be repeated.",
)
@click.option(
    "--at-once",
    type=click.IntRange(1, 256),
    default=WORKERS,
    show_default=True,
    help="How many take part at the same time; it changes no answer.",
)
@click.option(
    "--browser",
    "browsers",
    type=click.IntRange(0, 64),
    default=0,
    show_default=True,
    help="How many of the first to come take part in a real browser, in real time; all others "
    "without one.",
)
@click.option(
    "--speed",
    type=click.FloatRange(1, 1000),
    default=SPEED,
    show_default=True,
    help="How much faster than real the clock runs. A slower one makes rules about time tell.",
)
def command(
    folder: StudyFolder,
    participants: int | None,
    seed: int,
    shares: tuple[str, ...],
    strengths: tuple[str, ...],
    at_once: int,
    browsers: int,
    speed: float,
) -> None:
    """Let simulated participants take the study FOLDER over real HTTP.

    Then analyse what they answered, and say whether the analysis finds what they were given. All
    of it stays apart from real answers, in rehearsal.db and the folder rehearsal.
    """
    # The analysis takes a second to load, and nobody needs it for --help or a refusal.
    from studyapp.rehearsal.recovered import recover
    from studyapp.rehearsal.recovery_page import write_recovery
    from studyapp.rehearsal.recovery_words import recovery_lines

    people = default_population(with_others(folder.study(), shares, strengths))
    with progress("rehearse", "participant") as show:
        result = rehearse(
            folder,
            participants=participants,
            seed=seed,
            population=people,
            workers=at_once,
            browsers=browsers,
            speed=speed,
            on_done=show,
        )
    if result.note:
        click.echo(f"note: {result.note}")
    recovery = recover(folder)
    page = write_recovery(folder, recovery)
    for line in recovery_lines(recovery):
        click.echo(line)
    click.echo(_said(result))
    click.echo(f"What came of it is in {page}")


def _said(result: RehearsalResult) -> str:
    gone = f"; {result.left} left on the way" if result.left else ""
    return (
        f"{result.completed} simulated participants completed the study, {result.kept} of them "
        f"in an earlier run{gone}."
    )


def with_others(study: Study, shares: Sequence[str], strengths: Sequence[str]) -> Study:
    """Return `study` with another ``[rehearsal]`` than its file states.

    Parameters
    ----------
    shares : sequence of str
        Such as ``careless=0.2``.
    strengths : sequence of str
        Such as ``static=-0.5``, or ``static:emotion=-0.5`` for one question.

    Raises
    ------
    InputError
        If one is not written like that, or cannot be simulated.
    """
    if not shares and not strengths:
        return study
    stated: dict[str, Any] = study.rehearsal.model_dump()
    for text in shares:
        kind, share = _name_and_number(text, "--share", SHARE_REMEDY)
        kind = kind.replace("-", "_")
        if kind not in SHARES:
            raise InputError(f"unknown kind {kind!r}", where=f"--share {text}", remedy=SHARE_REMEDY)
        stated[kind] = share
    for text in strengths:
        about, logits = _name_and_number(text, "--strength", STRENGTH_REMEDY)
        condition, _, question = about.partition(":")
        own = stated["strength"].get(condition, {}) if question else {}
        stated["strength"][condition] = {**own, (question or EVERY_QUESTION): logits}
    try:
        made = Rehearsal.model_validate(stated)
    except ValidationError as error:
        raise InputError(
            explain(error), where="--share, --strength", remedy="Correct these options"
        ) from None
    conditions = (*study.conditions, study.catch.condition)
    if problems := made.problems(conditions, [question.name for question in study.questions]):
        raise InputError(
            "; ".join(problems), where="--strength", remedy="Name what is in the study file"
        )
    return study.model_copy(update={"rehearsal": made})


def _name_and_number(text: str, option: str, remedy: str) -> tuple[str, float]:
    name, sign, number = text.partition("=")
    try:
        value = float(number)
    except ValueError:
        sign, value = "", 0.0
    if not sign or not name.strip():
        raise InputError(f"{text!r} cannot be read", where=option, remedy=remedy)
    return name.strip(), value
