"""The arms of a study in its report, and which study sessions belong to its present design."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.participants import EVERYBODY, ArmState
from studyapp.results.stored_answers import StoredAnswers
from studyapp.study.settings.study import Study


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
