"""`motionjury export`."""

from pathlib import Path
from shlex import quote

import click

from motion.errors import counted
from studyapp.cli.arguments import FILE, FOLDER, refuse_options, study_folder
from studyapp.cli.output import sign_of_life
from studyapp.researchers.audit import read_reason
from studyapp.results.export.sharing import Shared, share
from studyapp.results.export.tables import export
from studyapp.study.folder import StudyFolder


@click.command("export")
@study_folder
@click.option(
    "--out",
    type=FILE,
    help="The main table, .csv or .parquet, by default responses.csv in the study folder; the "
    "other tables are written beside it.",
)
@click.option(
    "--folder",
    "shared_folder",
    type=FOLDER,
    help="Write a folder for another lab instead: behavioural data in BIDS, with everything "
    "needed to reproduce the report byte for byte.",
)
@click.option("--with-videos", is_flag=True, help="With --folder: include the videos.")
@click.option(
    "--with-free-text",
    is_flag=True,
    help="With --folder: include free text by participants, which may identify people.",
)
@click.option("--rehearsal", is_flag=True, help="Export the simulated participants instead.")
@click.option(
    "--withdrawn",
    is_flag=True,
    help="Export the remaining data of participants who withdrew instead; it is never analysed.",
)
@click.option(
    "--with-recruiter-ids",
    is_flag=True,
    help="Also write recruiter_ids.csv, which links pseudonyms to recruiters' ids.",
)
@click.option(
    "--reason",
    help="Why you export participants' answers; it is stored in the study's log of looks and, "
    "before the end of the study, in later reports.",
)
def command(
    folder: StudyFolder,
    out: Path | None,
    shared_folder: Path | None,
    with_videos: bool,
    with_free_text: bool,
    rehearsal: bool,
    withdrawn: bool,
    with_recruiter_ids: bool,
    reason: str | None,
) -> None:
    """Export the answers of the study FOLDER as tidy tables with a codebook.

    The main table has one row per answer. Further tables hold the participants (_participants),
    their answers to the form (_form), how each video was watched (_watching), refused requests
    (_refusals) and changes to the study (_log). Participants have pseudonyms.
    """
    checked_reason = "" if reason is None else read_reason(reason)
    if shared_folder is not None:
        refuse_options(("--out", "--withdrawn", "--with-recruiter-ids"), "--folder")
        with sign_of_life("export") as show:
            shared = share(
                folder,
                shared_folder,
                rehearsal=rehearsal,
                videos=with_videos,
                free_text=with_free_text,
                reason=checked_reason,
                on_step=show,
            )
        _print_shared(
            shared, shared_folder, "simulated participant" if rehearsal else "participant"
        )
        return
    refuse_options(("--with-videos", "--with-free-text"), "tables, only with --folder")
    prefix = ("rehearsal_" if rehearsal else "") + ("withdrawn_" if withdrawn else "")
    with sign_of_life("export") as show:
        show("reading answers and writing tables")
        exported = export(
            folder,
            out or folder.root / f"{prefix}responses.csv",
            rehearsal=rehearsal,
            withdrawn=withdrawn,
            with_recruiter_ids=with_recruiter_ids,
            reason=checked_reason,
        )
    click.echo(f"Wrote {counted(exported.answers, 'answer')} to {exported.files[0]}")
    click.echo(f"Written beside it: {', '.join(file.name for file in exported.files[1:])}")
    if exported.look:
        click.echo(exported.look)
    if not (exported.answers or rehearsal or withdrawn) and folder.rehearsal.exists():
        click.echo("Nobody has answered yet; --rehearsal exports the simulated participants.")


def _print_shared(shared: Shared, out: Path, person: str) -> None:
    click.echo(f"Wrote {counted(shared.participants, person)} to {out}")
    click.echo(f"To reproduce the results: motionjury report {quote(str(shared.study))}")
    for remark in shared.remarks:
        click.echo(remark)
    click.echo(
        "Before you share it: it holds study.toml unchanged, with contact and codes, and the "
        "study's speech and motion, whose licences must allow sharing."
    )
