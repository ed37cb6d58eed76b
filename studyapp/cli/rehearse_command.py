"""`motionjury rehearse`."""

from __future__ import annotations

import click

from studyapp.cli.arguments import study_folder
from studyapp.cli.output import progress
from studyapp.rehearsal.run import SPEED, RehearsalResult, rehearse
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

    with progress("rehearse", "participant") as show:
        result = rehearse(
            folder,
            participants=participants,
            seed=seed,
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
