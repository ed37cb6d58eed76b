"""`motionjury check`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.errors import InputError
from motion.files import write_text
from studyapp.cli.arguments import study_folder
from studyapp.cli.output import counted, sign_of_life
from studyapp.preflight.check import check
from studyapp.preflight.finding import record, summed_up, told
from studyapp.study.folder import StudyFolder


@click.command("check")
@study_folder
@click.option(
    "--json", "as_json", is_flag=True, help="Print what is found as JSON, for programs to read."
)
@click.option(
    "--verbose",
    "everything",
    is_flag=True,
    help="Print notes too, and each finding of a kind that is found often.",
)
@click.option(
    "--record",
    "recorded_in",
    metavar="FILE",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Also write the findings into FILE, as JSON.",
)
@click.option(
    "--address",
    metavar="URL",
    help="Where participants will find the study; looks whether it answers there.",
)
@click.option(
    "--pilot",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="A study that people have taken: their pace tells how long this one takes.",
)
def command(
    folder: StudyFolder,
    as_json: bool,
    recorded_in: Path | None,
    everything: bool,
    address: str | None,
    pilot: Path | None,
) -> None:
    """Find everything that can go wrong, before the study FOLDER is launched.

    Errors must be fixed; if there are any, the exit status is 1. Warnings need a decision, notes
    are worth knowing. docs/check.md lists every finding with its remedy.
    """
    with sign_of_life("check") as show:
        findings = check(
            folder,
            address=address,
            pilot=None if pilot is None else StudyFolder(pilot),
            on_step=show,
        )
    made = record(folder.root.resolve().name, findings)
    if recorded_in is not None:
        write_text(recorded_in, made.model_dump_json(indent=1))
    if as_json:
        click.echo(made.model_dump_json(indent=1))
        if made.errors:
            raise click.exceptions.Exit(1)
        return
    for line in told(findings, everything=everything):
        click.echo(line)
    if made.errors:
        things = "1 thing" if made.errors == 1 else f"{made.errors} things"
        raise InputError(
            f"{things} must be fixed before participants can take part ({summed_up(made)})",
            where=folder.root,
        )
    notes = f" (--verbose tells {counted(made.notes, 'note')})" if made.notes > 0 else ""
    rest = "" if everything else notes
    click.echo(f"{folder.root.resolve().name} can be served: {summed_up(made)}{rest}.")
