"""`motionjury exclude` and `motionjury forget`."""

from contextlib import closing

import click

from motion.errors import InputError
from studyapp.cli.arguments import StudyCommand, study_folder
from studyapp.clock import Clock
from studyapp.custody.forgetting import StoredData, find_data, forget, has_forgotten
from studyapp.database.engine import Database, database_url_of, missing_database
from studyapp.database.scrubbing import scrub
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.researchers.pseudonyms import PseudonymKey, find_number_by_name
from studyapp.results.answers import snapshot
from studyapp.study.folder import StudyFolder


@click.command("exclude", cls=StudyCommand)
@study_folder
@click.argument("participant")
@click.option(
    "--reason",
    required=True,
    help="The reason. The log, reports and exports show it, so do not identify the person.",
)
@click.option(
    "--reinstate", is_flag=True, help="Include a participant again who was excluded by hand."
)
def command(folder: StudyFolder, participant: str, reason: str, reinstate: bool) -> None:
    """Exclude PARTICIPANT of the study FOLDER from the analysis.

    PARTICIPANT is the number of the study session in reports and on researchers' pages, or the
    pseudonym in exports. A participant who is still taking part can finish and is paid; the place
    stays taken. No answer is deleted.
    """
    with snapshot(folder, "participants") as session:
        if session is None:
            raise missing_database(database_url_of(folder.root))
        key = PseudonymKey.read(folder.pseudonym_key)
        number = find_number_by_name(session, key, participant)
    if number is None:
        raise InputError(
            f"there is no study session {participant!r}",
            where=folder.root,
            remedy="Give its number in reports and on researchers' pages, or the participant's "
            "pseudonym in exports",
        )
    with closing(Database.open(database_url_of(folder.root))) as database:
        decide_exclusion(database, Clock(), number, excluded=not reinstate, by="", reason=reason)
    state = (
        "no longer excluded by hand; the exclusion rules still apply"
        if reinstate
        else "excluded from the analysis, marked as exploratory; --reinstate undoes this"
    )
    click.echo(f"Study session {number} is {state}. Report and export again.")


def _erase(folder: StudyFolder, name: str) -> None:
    """Erase a participant, and rewrite the database's files, also if an earlier run did not.

    Raises
    ------
    InputError
        If the files cannot be rewritten; the participant is erased all the same.
    """
    with closing(Database.open(database_url_of(folder.root))) as database:
        count = forget(database, name, PseudonymKey.read(folder.pseudonym_key), Clock())
        if count or has_forgotten(database):
            scrub(database)


@click.command("forget", cls=StudyCommand)
@study_folder
@click.argument("participant")
@click.option("--yes", is_flag=True, help="Erase without asking.")
def forget_command(folder: StudyFolder, participant: str, yes: bool) -> None:
    """Erase PARTICIPANT of the study FOLDER, even while they are answering.

    PARTICIPANT is the recruiter's id, the pseudonym in exports, the completion code, or the link of
    an invitation. Before anything is erased, the command prints what will be erased and what will
    remain.
    """
    with closing(Database.open_existing(database_url_of(folder.root))) as database:
        entries = find_data(database, participant, PseudonymKey.read(folder.pseudonym_key))
    if not entries:
        _erase(folder, participant)
        click.echo(
            "No participant has this recruiter id, pseudonym, completion code or invitation (any "
            "more), so nothing was erased. Check the spelling."
        )
        return
    for entry in entries:
        click.echo(_describe_erasure(entry))
    click.echo(
        "What remains: one row that a study session in this arm was erased, and when; a line in "
        "the log with its number but no name; and the place, which somebody else can take while "
        "the study is open. A participant who returns with the same id starts from the beginning. "
        "Later reports do not count erased answers, even if they were analysed before."
    )
    if not (yes or click.confirm("Erase this permanently?")):
        click.echo("Nothing was erased.")
        return
    _erase(folder, participant)
    click.echo("Erased; nothing is left in the database's files.")
    click.echo(
        "Left to do by hand: tables, the report and files of jobs in the study folder may still "
        "hold their data: export and report again, or remove them. Shared folders and tables, "
        "backups, and the recruiter's own records cannot be reached from here."
    )


def _describe_erasure(entry: StoredData) -> str:
    if entry.study_session is None:
        return "Screened out. To be erased: that this happened."
    return (
        f"Study session {entry.study_session} ({entry.state}, arm {entry.arm}). To be erased: "
        f"{entry.answers} answers with their trials, all records of watching, answers to the form, "
        "refused requests, the recruiter's ids, the completion code, and whether and why "
        "researchers excluded the participant."
    )
