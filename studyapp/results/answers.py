"""What has been answered so far, by participants or in a rehearsal, and by which arms."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sqlalchemy.orm import Session

from analysis.answers.participants import EVERYBODY, ArmState
from motion.errors import InputError
from studyapp.database.engine import Database, database_url_of
from studyapp.results.shared_answers import read_shared_answers
from studyapp.results.stated_beforehand import stated_study
from studyapp.results.stored_answers import (
    NO_ANSWERS,
    Answers,
    Source,
    StoredAnswers,
    stored_answers,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def answers_to_report(folder: StudyFolder) -> Answers:
    """Return the real answers where there are any, else the rehearsal's, else none."""
    real = read_answers(folder, "participants")
    if real.origin != "none":
        return real
    rehearsed = read_answers(folder, "rehearsal")
    return real if rehearsed.origin == "none" else rehearsed


def read_rehearsal(folder: StudyFolder) -> Answers:
    """Return the rehearsal's answers.

    Raises
    ------
    InputError
        If there are none.
    """
    rehearsed = read_answers(folder, "rehearsal")
    if rehearsed.origin == "none":
        raise InputError(
            "nothing has been rehearsed",
            where=folder.root,
            remedy="Run 'motionjury rehearse' first, or leave out --rehearsal",
        )
    return rehearsed


def read_answers(folder: StudyFolder, origin: Source) -> Answers:
    """Return the answers of participants or of a rehearsal; the database is left as it is.

    Where another lab has passed the study on, its files take the place of a database.
    """
    if folder.shared_answers.is_dir():
        return _shared(folder, origin)
    with snapshot(folder, origin) as session:
        return answers_in(session, origin)


def answers_in(session: Session | None, origin: Source, *, in_full: bool = False) -> Answers:
    """Return the answers in a `snapshot`, for whoever reads more of the same state.

    For `in_full` see `stored_answers`.
    """
    if session is None:
        return NO_ANSWERS
    stored = stored_answers(session, in_full=in_full)
    sessions = stored.study_sessions
    versions = sessions.loc[of_present_design(sessions), "version"]
    stated = None if versions.empty else stated_study(session, int(versions.min()))
    return Answers(origin="none" if stored.answers.empty else origin, stored=stored, stated=stated)


def _shared(folder: StudyFolder, origin: Source) -> Answers:
    for database in (folder.responses, folder.rehearsal):
        if database.exists():
            raise InputError(
                "there is a database beside the answers that another lab has passed on",
                where=database,
                remedy=f"Move one of them elsewhere: the database, or {folder.shared_answers}",
            )
    return read_shared_answers(folder.shared_answers, origin)


@contextmanager
def snapshot(folder: StudyFolder, origin: Source) -> Iterator[Session | None]:
    """Give one state of the database that holds the answers; None where there is none yet.

    Whatever is read in it belongs together, whoever withdraws meanwhile.

    Raises
    ------
    InputError
        If another lab has passed the study on, so that its tables are there already.
    """
    if folder.shared_answers.is_dir():
        raise InputError(
            "this study has been passed on, with tables in place of a database",
            where=folder.shared_answers,
            remedy="Use the tables of the folder that it lies in, or report it",
        )
    url = database_url_of(folder.root, rehearsal=origin == "rehearsal")
    database = Database.open_for_reading(url)
    if database is None:
        yield None
        return
    with closing(database), database.reading() as session:
        yield session


def of_present_design(study_sessions: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell which study sessions were asked what the latest of their arm were asked.

    A new version of a study may change what the participants of an arm see; answers from before
    are then answers to something else. An arm that it leaves alone keeps its participants.
    """
    latest = (
        study_sessions.sort_values(["version", "study_session"])
        .groupby("arm", sort=False)["arm_design"]
        .last()
    )
    return np.asarray(
        study_sessions["arm"].map(latest).to_numpy(object)
        == study_sessions["arm_design"].to_numpy(object),
        bool,
    )


def arm_states(study: Study, stored: StoredAnswers) -> tuple[ArmState, ...]:
    """Return what is known of each arm's participants, in the order of the study.

    Parameters
    ----------
    study : Study
        With its places.
    stored : StoredAnswers
        All study sessions, and how many places there are beyond those of the study.
    """
    study_sessions = stored.study_sessions
    places = {arm.name: arm.places + stored.more_places for arm in study.arms}
    names = dict.fromkeys((*places, *map(str, study_sessions["arm"])))
    present = of_present_design(study_sessions)
    withdrawn = study_sessions["withdrawn"].to_numpy(bool)
    completed = study_sessions["completed"].to_numpy(bool)
    unwatched = study_sessions["unwatched"].to_numpy(bool) & ~withdrawn
    states = []
    for name in names:
        own = (study_sessions["arm"] == name).to_numpy(bool)
        states.append(
            ArmState(
                arm=name if len(names) > 1 else EVERYBODY,
                places=places.get(name),
                opened=int(own.sum()),
                withdrawn=int((own & withdrawn).sum()),
                earlier=int((own & ~present & ~withdrawn).sum()),
                unwatched=int((own & present & unwatched).sum()),
                completed=int((own & present & ~withdrawn & completed).sum()),
            )
        )
    return tuple(states)


def arm_of_each(study: Study, study_sessions: pd.DataFrame) -> dict[str, str]:
    """Return the arm of each study session under the name that `arm_states` gives it."""
    arms = study_sessions["arm"].astype(str)
    names = {arm.name for arm in study.arms} | set(arms)
    one = len(names) == 1
    return {
        str(session): EVERYBODY if one else arm
        for session, arm in zip(study_sessions["study_session"].tolist(), arms, strict=True)
    }
