"""`motionjury rehearse`."""

from __future__ import annotations

import click

from studyapp.cli.arguments import study_folder
from studyapp.cli.progress import progress
from studyapp.rehearsal.run import SPEED, WORKERS, RehearsalResult, rehearse
from studyapp.rehearsal.simulation.population import default_population
from studyapp.study.creation.written_rehearsal import with_others
from studyapp.study.folder import StudyFolder


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
    from studyapp.rehearsal.recovery.page import write_recovery
    from studyapp.rehearsal.recovery.recovery import recover
    from studyapp.rehearsal.recovery.words import recovery_lines

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
