"""The answers so far, of participants or a rehearsal, and the state of each arm."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any

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
    """Return the real answers if there are any, else the rehearsal's, else none."""
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
            remedy="Run 'motionjury rehearse' first, or omit --rehearsal",
        )
    return rehearsed


def read_answers(folder: StudyFolder, origin: Source) -> Answers:
    """Return the answers of participants or of a rehearsal, without changing the database.

    A study from another lab has files instead of a database.
    """
    if folder.shared_answers.is_dir():
        return _shared(folder, origin)
    with snapshot(folder, origin) as session:
        return answers_in(session, origin)


def answers_in(session: Session | None, origin: Source, *, in_full: bool = False) -> Answers:
    """Return the answers in a `snapshot`; for `in_full` see `stored_answers`."""
    if session is None:
        return NO_ANSWERS
    stored = stored_answers(session, in_full=in_full)
    sessions = stored.study_sessions
    versions = sessions.loc[has_current_design(sessions), "version"]
    stated = None if versions.empty else stated_study(session, int(versions.min()))
    return Answers(origin="none" if stored.answers.empty else origin, stored=stored, stated=stated)


def _shared(folder: StudyFolder, origin: Source) -> Answers:
    for database in (folder.responses, folder.rehearsal):
        if database.exists():
            raise InputError(
                "this study has both a database and answers from another lab",
                where=database,
                remedy=f"Move either the database or {folder.shared_answers} elsewhere",
            )
    return read_shared_answers(folder.shared_answers, origin)


@contextmanager
def snapshot(folder: StudyFolder, origin: Source) -> Iterator[Session | None]:
    """Yield a consistent state of the database with the answers; None if there is none.

    Raises
    ------
    InputError
        If the study comes from another lab, with tables instead of a database.
    """
    if folder.shared_answers.is_dir():
        raise InputError(
            "this study comes from another lab, with tables instead of a database",
            where=folder.shared_answers,
            remedy="Use the tables in the shared folder, or report the study",
        )
    url = database_url_of(folder.root, rehearsal=origin == "rehearsal")
    database = Database.open_for_reading(url)
    if database is None:
        yield None
        return
    with closing(database), database.reading() as session:
        yield session


def has_current_design(study_sessions: pd.DataFrame) -> NDArray[np.bool_]:
    """Return which study sessions have the current design of their arm.

    A new version of a study may change what participants of an arm see; earlier answers then
    belong to another design. Arms that do not change keep their participants.
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
    """Return the state of each arm, in the order of the study.

    Parameters
    ----------
    study : Study
        The study with its places.
    stored : StoredAnswers
        All study sessions, and the number of additional places.
    """
    sessions = stored.study_sessions
    places = {arm.name: arm.places + stored.more_places for arm in study.arms}
    names = dict.fromkeys((*places, *map(str, sessions["arm"])))
    present, withdrawn = has_current_design(sessions), sessions["withdrawn"]
    counts = (
        pd.DataFrame(
            {
                "opened": np.ones(len(sessions), bool),
                "withdrawn": withdrawn,
                "earlier": ~present & ~withdrawn,
                "unwatched": present & ~withdrawn & sessions["unwatched"],
                "completed": present & ~withdrawn & sessions["completed"],
            }
        )
        .groupby(sessions["arm"].astype(str))
        .sum()
        .reindex(list(names), fill_value=0)
    )
    states = []
    for name in names:
        count: dict[Any, int] = counts.loc[name].to_dict()
        arm = name if len(names) > 1 else EVERYBODY
        states.append(ArmState(arm=arm, places=places.get(name), **count))
    return tuple(states)


def arm_by_session(study: Study, study_sessions: pd.DataFrame) -> dict[str, str]:
    """Return the name in `arm_states` of each study session's arm."""
    arms = study_sessions["arm"].astype(str)
    names = {arm.name for arm in study.arms} | set(arms)
    single = len(names) == 1
    return {
        str(session): EVERYBODY if single else arm
        for session, arm in zip(study_sessions["study_session"].tolist(), arms, strict=True)
    }
