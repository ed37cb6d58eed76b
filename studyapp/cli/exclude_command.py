"""`motionjury exclude`."""

from __future__ import annotations

from contextlib import closing

import click

from motion.errors import InputError
from studyapp.cli.arguments import study_folder
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of
from studyapp.monitoring.naming import number_called
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.researchers.pseudonyms import PseudonymKey
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
            number = number_called(session, PseudonymKey.read(folder.pseudonym_key), name)
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
@study_folder
@click.argument("participant")
@click.option(
    "--reason",
    required=True,
    help="Why. It stands in the log, reports and exports: write nothing that tells who it is.",
)
@click.option("--reinstate", is_flag=True, help="Take somebody in again who was excluded so.")
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
