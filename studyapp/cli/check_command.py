"""`motionjury check`."""

from pathlib import Path

import click

from motion.errors import InputError, counted
from motion.files import write_text
from studyapp.cli.arguments import FILE, check_address, study_folder
from studyapp.cli.output import sign_of_life
from studyapp.preflight.check import check
from studyapp.preflight.finding import make_record, text_lines
from studyapp.study.folder import StudyFolder


@click.command("check")
@study_folder
@click.option(
    "--verbose", "everything", is_flag=True, help="Print notes too, and all findings of each kind."
)
@click.option(
    "--record",
    "record_file",
    metavar="FILE",
    type=FILE,
    help="Also write the findings into FILE, as JSON.",
)
@click.option(
    "--address",
    metavar="URL",
    callback=lambda context, parameter, value: value and check_address(value),
    help="The study's public address; also checks that the study answers there.",
)
def command(
    folder: StudyFolder, record_file: Path | None, everything: bool, address: str | None
) -> None:
    """Check the study FOLDER before it is launched.

    Errors must be fixed; if there are any, the exit status is 1. Warnings need a decision, notes
    are worth knowing. docs/check.md lists every finding with its remedy.
    """
    with sign_of_life("check") as show:
        findings = check(folder, address=address, on_step=show)
    record = make_record(folder.root.resolve().name, findings)
    if record_file is not None:
        write_text(record_file, record.model_dump_json(indent=1))
    for line in text_lines(findings, everything=everything):
        click.echo(line)
    if record.errors:
        raise InputError(
            f"errors must be fixed before participants can take part ({record.summary})",
            where=record.study,
        )
    hidden = record.notes and not everything
    notes = f" (--verbose prints {counted(record.notes, 'note')})" if hidden else ""
    click.echo(f"{record.study} can be served: {record.summary}{notes}.")
