"""`motionjury export`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.errors import InputError
from studyapp.cli.arguments import refuse_beside, study_folder
from studyapp.cli.output import counted
from studyapp.researchers.audit import read_reason
from studyapp.results.export.sharing import Shared, share
from studyapp.results.export.writing import export
from studyapp.study.folder import StudyFolder


@click.command("export")
@study_folder
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="The main table, .csv or .parquet; responses.csv in the study folder by default. The "
    "others lie beside it.",
)
@click.option(
    "--folder",
    "shared",
    type=click.Path(path_type=Path, file_okay=False),
    help="Write a folder for another lab instead: BIDS' behavioural data, and all it takes "
    "to repeat the report byte for byte.",
)
@click.option("--with-videos", is_flag=True, help="With --folder: copy the videos too.")
@click.option(
    "--with-free-text",
    is_flag=True,
    help="With --folder: add what participants wrote in their own words. It may name people.",
)
@click.option("--rehearsal", is_flag=True, help="Export the simulated participants instead.")
@click.option(
    "--withdrawn",
    is_flag=True,
    help="Export what was kept of participants who withdrew instead; it is never analysed.",
)
@click.option(
    "--with-recruiter-ids",
    is_flag=True,
    help="Also write recruiter_ids.csv: who is behind each pseudonym. It names people.",
)
@click.option(
    "--reason",
    help="Why you export participants' answers; it is kept in the study's log of looks and, if "
    "you export before the end, in later reports.",
)
def command(
    folder: StudyFolder,
    out: Path | None,
    shared: Path | None,
    with_videos: bool,
    with_free_text: bool,
    rehearsal: bool,
    withdrawn: bool,
    with_recruiter_ids: bool,
    reason: str | None,
) -> None:
    """Write the answers of the study FOLDER as tidy tables, with a codebook.

    The main table has one row for each answer. Tables beside it hold the participants, what they
    said about themselves (_form), how each video was watched (_watching), which requests were
    refused (_refusals) and what was changed meanwhile (_log). Participants have pseudonyms.
    """
    if reason is not None and (rehearsal or withdrawn):
        raise InputError(
            "--reason is for answers that are analysed, which alone are logged as seen",
            where="--reason",
            remedy="Leave it out",
        )
    why = "" if reason is None else read_reason(reason)
    if shared is not None:
        refuse_beside(
            {
                "--out": out,
                "--withdrawn": withdrawn,
                "--with-recruiter-ids": with_recruiter_ids,
            },
            "--folder",
        )
        done = share(
            folder,
            shared,
            rehearsal=rehearsal,
            videos=with_videos,
            free_text=with_free_text,
            reason=why,
        )
        _say_shared(done, shared)
        return
    if with_videos or with_free_text:
        raise InputError(
            "--with-videos and --with-free-text are for a folder for another lab",
            remedy="Add --folder OUT, or leave them out",
        )
    kinds = ("rehearsal_" if rehearsal else "") + ("withdrawn_" if withdrawn else "")
    path = out or folder.root / f"{kinds}responses.csv"
    written = export(
        folder,
        path,
        rehearsal=rehearsal,
        withdrawn=withdrawn,
        with_recruiter_ids=with_recruiter_ids,
        reason=why,
    )
    click.echo(f"Wrote {counted(written.answers, 'answer')} to {written.files[0]}")
    click.echo(f"Beside it: {', '.join(file.name for file in written.files[1:])}")
    for remark in filter(None, (written.remark, written.look)):
        click.echo(remark)
    if not (written.answers or rehearsal or withdrawn) and folder.rehearsal.exists():
        click.echo("Nobody has answered yet; --rehearsal exports the simulated participants.")


def _say_shared(done: Shared, out: Path) -> None:
    click.echo(f"Wrote {counted(done.participants, 'participant')} to {out}")
    click.echo(f"There, 'motionjury report {done.study}' repeats the results.")
    for remark in done.remarks:
        click.echo(remark)
    click.echo(
        "Before you pass it on: it holds study.toml as it is, with contact and codes, and the "
        "study's speech and motion, whose licence must allow that."
    )
