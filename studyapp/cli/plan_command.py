"""`motionjury plan` and `motionjury rehearse`."""

from typing import Any

import click

from studyapp.cli.arguments import Number, study_folder
from studyapp.cli.output import echo_note, echo_table, progress
from studyapp.rehearsal import SPEED
from studyapp.study.folder import StudyFolder


class _NumberListType(click.ParamType[tuple[Any, ...]]):
    """Numbers separated by commas."""

    name = "numbers"

    def __init__(self, item: click.ParamType[Any]) -> None:
        self._item = item

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Any, ...]:
        if isinstance(value, tuple):
            return value
        return tuple(self._item.convert(text, param, ctx) for text in str(value).split(","))


@click.command("plan")
@study_folder
@click.option(
    "--participants",
    type=_NumberListType(click.IntRange(1, 10_000)),
    default=(),
    metavar="N,…",
    help="Numbers of participants to try: per comparison if each has its own, else of the study.  "
    "[default: 1, 2, 4 and 8 times the study's]",
)
@click.option(
    "--items",
    type=_NumberListType(click.IntRange(1, 10_000)),
    default=(),
    metavar="N,…",
    help="Numbers of segments to try.  [default: the study's, and twice that]",
)
@click.option(
    "--effect",
    "effects",
    type=_NumberListType(Number(0, 10)),
    default=(0.2, 0.4, 0.6),
    show_default=False,
    metavar="X,…",
    help="Differences between conditions to try, in logits.  [default: 0.2,0.4,0.6]",
)
def command(folder: StudyFolder, **options: Any) -> None:
    """Simulate a study to find how many participants and segments it needs.

    Simulated participants answer the study in FOLDER in several sizes, and the report's own tests
    are applied. If the study has no speech yet, give the number of segments with --items.
    """
    # Imported here: statistics take seconds to load, which --help should not wait for.
    from analysis.planning.writing import plan_sentences, power_lines
    from studyapp.planning.plan import plan_study

    with progress("simulating", "cell") as show:
        plan = plan_study(folder, **options, show=show)
    out = folder.root / "plan"
    click.echo("\n".join((*power_lines(plan), "", *plan_sentences(plan), "")))
    click.echo(f"The figure is {out / 'power.png'}, the numbers are {out / 'power.csv'}")


@click.command("rehearse")
@study_folder
@click.option(
    "--participants",
    type=click.IntRange(1, 10_000),
    help="Simulated participants: per comparison if each has its own, else of the study. By "
    "default as many as the study asks for.",
)
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=1)
@click.option(
    "--speed",
    type=Number(1, 1000),
    default=SPEED,
    help="How many times faster than real time the clock runs. Rules about time need a slow clock.",
)
def rehearse_command(
    folder: StudyFolder,
    participants: int | None,
    seed: int,
    speed: float,
) -> None:
    """Let simulated participants take the study FOLDER over real HTTP.

    Then analyse their answers, and report whether the analysis recovers the preferences that they
    were given. Everything is kept apart from real answers, in rehearsal.db and the folder
    rehearsal.
    """
    # Imported here: the analysis takes a second to load, which --help should not wait for.
    from studyapp.rehearsal.recovered import recover
    from studyapp.rehearsal.recovery_page import recovery_lines, values_in_words, write_recovery
    from studyapp.rehearsal.run import rehearse

    with progress("rehearse", "participant") as show:
        result = rehearse(
            folder,
            participants=participants,
            seed=seed,
            speed=speed,
            on_done=show,
        )
    if result.note:
        echo_note(result.note)
    recovery = recover(folder)
    page = write_recovery(folder, recovery)
    if recovery.values:
        echo_table(*values_in_words(recovery))
    for line in recovery_lines(recovery):
        click.echo(line)
    dropouts = f"; {result.left} dropped out" if result.left else ""
    click.echo(
        f"{result.completed} simulated participants completed the study, {result.kept} of them "
        f"in an earlier run{dropouts}."
    )
    click.echo(f"The results are in {page}")
