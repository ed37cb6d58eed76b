"""Export: what participants answered, as tables that hold no token and no name.

Cells stand under the headings that `columns.toml` declares; the codebook is made from
those. Of what is read here and has no heading there, nothing is exported.
"""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd
from sqlalchemy import select
from sqlalchemy.orm import Session

from studyapp.database.tables import FormAnswer
from studyapp.results.answer_table import sides
from studyapp.results.stored_answers import StoredAnswers, whose_answers


def answers_table(stored: StoredAnswers) -> pd.DataFrame:
    """Return every stored answer, one row per answered question and stimulus.

    Answers of all kinds of trial and of unfinished study sessions are included.

    Of a trial that shows two stimuli, `left_…` and `right_…` say what was A and B, and
    `comparison` names the pair: `reference` is the one the study puts first. Of a catch trial,
    `other` is the visibly flawed condition and `reference` the one it is shown beside. These
    columns are empty for other trials. An answer about one stimulus names it in `stimulus` (its
    number), `condition` and `speech`, which are empty for answers about the whole trial. The
    `reasons` ticked for an order stand beside each of its ranks.

    Parameters
    ----------
    stored : StoredAnswers
        In full.

    Returns
    -------
    DataFrame
        Ordered by study session, position and answer.
    """
    own = stored.study_sessions[["study_session", "version", "arm", "conditions"]]
    trials = stored.trials.merge(own, on="study_session")
    pairs = _pairs(trials.merge(sides(stored.stimuli), on="trial"))
    about = stored.stimuli.rename(columns={"number": "stimulus"}).drop(columns="segment")
    rows = stored.answers.merge(trials, on="trial").merge(pairs, on="trial", how="left")
    rows = rows.merge(about, on=["trial", "stimulus"], how="left")
    numbers = rows["expected"].astype("Int64").astype("string")
    return rows.assign(
        stimulus=rows["stimulus"].replace(0, None),
        expected=rows["side"].where(rows["side"].notna(), numbers),
        reasons=[" ".join(reasons) for reasons in rows["reasons"]],
    )


def _pairs(trials: pd.DataFrame) -> pd.DataFrame:
    """Return the columns about a pair, one row for each trial that shows one."""
    columns = ["trial", "left_condition", "right_condition", "left_speech", "right_speech"]
    named = trials.rename(
        columns={
            f"{what}_{side}": f"{side}_{what}"
            for what in ("condition", "speech")
            for side in ("left", "right")
        }
    )
    order = list(_in_order(trials))
    return named[columns].assign(
        comparison=[
            arm if len(conditions) == 2 else "-".join(pair)
            for arm, conditions, pair in zip(
                trials["arm"], trials["conditions"], order, strict=True
            )
        ],
        reference=[reference for reference, _ in order],
        other=[other for _, other in order],
        side=trials["expected"].map({1.0: "left", 2.0: "right"}),
    )


def _in_order(trials: pd.DataFrame) -> Iterator[tuple[str, str]]:
    """Yield the two conditions of each trial, the reference first."""
    for left, right, expected, conditions in zip(
        *(trials[name] for name in ("condition_left", "condition_right", "expected", "conditions")),
        strict=True,
    ):
        if pd.isna(expected):
            reference, other = sorted((left, right), key=conditions.index)
        else:
            reference, other = (left, right) if expected == 1 else (right, left)
        yield reference, other


def participants_table(stored: StoredAnswers) -> pd.DataFrame:
    """Return every study session and where it stands, for the participant flow.

    `state` is ``instructed``, ``started``, ``completed``, ``unwatched``, ``withdrawn`` or
    ``lapsed`` (silent for so long that the place was given back).
    """
    found = stored.study_sessions
    return found.rename(columns={"trials": "presentations"}).assign(
        answered=found["settled"] - found["unplayable"]
    )


def form_answers_table(session: Session, *, withdrawn: bool = False) -> pd.DataFrame:
    """Return what participants said about themselves, one row per answered question.

    Who withdrew is left out. With `withdrawn`, nobody else is in it.
    """
    columns = (FormAnswer.study_session_id, FormAnswer.stage, FormAnswer.question, FormAnswer.value)
    query = select(*columns).join(FormAnswer.study_session).where(whose_answers(withdrawn))
    rows = session.execute(query.order_by(FormAnswer.study_session_id, FormAnswer.id)).all()
    return pd.DataFrame(rows, columns=["study_session", "stage", "question", "value"])
