"""`motionjury exclude` and `motionjury forget`."""

from __future__ import annotations

from contextlib import closing

import click

from motion.errors import InputError, listed
from studyapp.cli.arguments import named_study_folder
from studyapp.clock import Clock
from studyapp.custody.forgetting import Remembered, forget, has_forgotten, remembered
from studyapp.database.engine import Database, database_url_of
from studyapp.database.scrubbing import scrub
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.researchers.pseudonyms import PseudonymKey, find_number_by_name
from studyapp.results.answers import snapshot
from studyapp.study.folder import StudyFolder


def decide_about(folder: StudyFolder, name: str, *, excluded: bool, reason: str) -> int:
    """Leave a participant out of the analysis, or take one in again; return the study session.

    Parameters
    ----------
    name : str
        The number of the study session, or the participant's pseudonym.

    Raises
    ------
    InputError
        If nobody is called so, no reason is given, it is so already, or the study was passed on
        by another lab.
    """
    with snapshot(folder, "participants") as session:
        number = None
        if session is not None:
            number = find_number_by_name(session, PseudonymKey.read(folder.pseudonym_key), name)
    if number is None:
        raise InputError(
            f"no study session is called {name!r}",
            where=folder.root,
            remedy="Give its number, as reports and researchers' pages have it, or the "
            "participant's pseudonym from an export",
        )
    with closing(Database.open(database_url_of(folder.root))) as database:
        decide_exclusion(database, Clock(), number, excluded=excluded, by="", reason=reason)
    return number


@click.command("exclude")
@named_study_folder
@click.argument("participant")
@click.option(
    "--reason",
    required=True,
    help="Why. The log, reports and exports show it: write nothing that identifies the person.",
)
@click.option("--reinstate", is_flag=True, help="Include somebody again who was excluded this way.")
def command(folder: StudyFolder, participant: str, reason: str, reinstate: bool) -> None:
    """Leave PARTICIPANT of the study FOLDER out of the analysis.

    PARTICIPANT is the number of the study session, as in reports and on researchers' pages, or the
    pseudonym of an export. Whoever is still taking part goes on and is paid; the place stays
    taken. No answer is deleted.
    """
    number = decide_about(folder, participant, excluded=not reinstate, reason=reason)
    if reinstate:
        click.echo(
            f"Study session {number} is no longer excluded by hand. The exclusion rules of the "
            "study file hold as before. Report and export again."
        )
        return
    click.echo(
        f"Study session {number} is left out of the analysis, which reports mark as exploratory. "
        "Report and export again. --reinstate takes it back."
    )


def remembered_of(folder: StudyFolder, name: str) -> tuple[Remembered, ...]:
    """Return what is stored of the participant called `name`; the database is left as it is."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return ()
    with closing(database):
        return remembered(database, name, PseudonymKey.read(folder.pseudonym_key))


def forget_participant(folder: StudyFolder, name: str) -> int:
    """Erase the participant called `name`, and return how many entries of `remembered_of` went.

    The database's files are written anew, also where an earlier run was kept from it.

    Raises
    ------
    InputError
        If the files cannot be written anew; the participant is erased all the same.
    """
    url = database_url_of(folder.root)
    there = Database.open_for_reading(url)
    if there is None:
        return 0
    there.close()
    with closing(Database.open(url)) as database:
        key = PseudonymKey.read(folder.pseudonym_key)
        count = forget(database, name, key, Clock())
        if count or has_forgotten(database):
            scrub(database)
    return count


def copies_left(folder: StudyFolder) -> tuple[str, ...]:
    """Return the files beside the study that may still hold a participant, as they are called."""
    tables = sorted(
        path.name
        for path in folder.root.glob("*")
        if path.suffix in (".csv", ".parquet") and path.is_file() and path.name != "metrics.parquet"
    )
    folders = [path.name for path in (folder.report, folder.jobs) if path.exists()]
    return (*tables, *(f"{name}/" for name in folders))


@click.command("forget")
@named_study_folder
@click.argument("participant")
@click.option("--yes", is_flag=True, help="Erase without asking.")
def forget_command(folder: StudyFolder, participant: str, yes: bool) -> None:
    """Erase PARTICIPANT of the study FOLDER, who may be answering at this moment.

    PARTICIPANT is the recruiter's id, the pseudonym of an export, or the completion code. What is
    erased and what remains is said before anything happens.
    """
    found = remembered_of(folder, participant)
    if not found:
        forget_participant(folder, participant)
        click.echo(
            "Nobody in this study has that recruiter id, pseudonym or completion code (any more): "
            "nothing was erased. If there should be somebody, check how it is written."
        )
        return
    for one in found:
        click.echo(_what_goes(one))
    click.echo(
        "What remains: one row that says that a study session in this arm is gone, and since when; "
        "a line in the log with its number and no name; and the place, which somebody else can "
        "take while the study is open. Whoever comes again under the same id begins anew. Erased "
        "answers count in no later report, also where they were analysed before."
    )
    if not yes:
        click.confirm("Erase this for good?", abort=True)
    forget_participant(folder, participant)
    click.echo("Erased, and nothing is left in the database's files.")
    click.echo(_by_hand(folder))


def _what_goes(one: Remembered) -> str:
    if one.study_session is None:
        return "Screened out, found by the recruiter's id. What goes: that it was so."
    return (
        f"Study session {one.study_session} ({one.state}, arm {one.arm}), found by its "
        f"{one.known_as}. What goes: {one.answers} answers with their trials, "
        f"{one.watch_records} records of what was watched, {one.form_answers} answers about the "
        f"person, {one.refusals} refused requests, the recruiter's ids, the completion code, and "
        "whether and why researchers excluded them."
    )


def _by_hand(folder: StudyFolder) -> str:
    copies = copies_left(folder)
    here = (
        f"Beside the study, {listed(copies)} may still hold them: export and report again, or "
        "remove these. "
        if copies
        else ""
    )
    return (
        f"Left to do by hand: {here}Folders and tables given to others, backups of the database "
        "and of its server, and the recruiter's own records are out of reach from here."
    )
