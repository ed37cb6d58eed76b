"""Storing the planned trials of a participant: one statement a table.

The rows are sent as one JSON text, which the database unpacks. Sent as parameters, the 150 rows of
a study session took longer than everything else in an enrolment.
"""

from __future__ import annotations

import json
import secrets
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final

from sqlalchemy import (
    ColumnElement,
    Insert,
    String,
    Text,
    bindparam,
    cast,
    column,
    insert,
    literal_column,
    select,
    tuple_,
)
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.orm import Session, aliased
from sqlalchemy.sql.compiler import SQLCompiler
from sqlalchemy.sql.functions import GenericFunction
from sqlalchemy.types import TypeEngine

from analysis.answers.table import ANALYSED_KINDS
from studyapp.database.tables import Base, Response, StudySession, Trial, TrialStimulus, Video
from studyapp.researchers.exclusion_decisions import current_exclusions
from studyapp.session.served_study import ServedStudy
from studyapp.session.shown_trials import numbered_stimuli
from studyapp.study.design.trial import NO_VOTES, PlannedTrial, Tally

TOKEN_BYTES: Final = 24
"""Random bytes of every token: 192 bits."""

TOKEN_LENGTH: Final = TOKEN_BYTES * 4 // 3
"""Letters of a token, six bits each."""


class json_rows(GenericFunction[Any]):  # noqa: N801 - SQLAlchemy takes the function's name from it
    """The elements of a JSON list as rows with one column, `value`."""

    inherit_cache = True


@compiles(json_rows, "sqlite")
def _on_sqlite(rows: json_rows, compiler: SQLCompiler, **options: Any) -> str:
    return f"json_each({compiler.process(rows.clauses, **options)})"


@compiles(json_rows, "postgresql")
def _on_postgresql(rows: json_rows, compiler: SQLCompiler, **options: Any) -> str:
    return f"jsonb_array_elements(CAST({compiler.process(rows.clauses, **options)} AS jsonb))"


ROWS: Final = json_rows(bindparam("rows", type_=Text)).table_valued(column("value"), name="given")


def _field(name: str, kind: TypeEngine[Any]) -> ColumnElement[Any]:
    """Return the field `name` of a JSON row."""
    text = ROWS.c.value.op("->>", return_type=String())(literal_column(f"'{name}'"))
    return text if isinstance(kind, String) else cast(text, kind)


def _insert_rows(model: type[Base], fields: Sequence[str], constants: dict[str, Any]) -> Insert:
    """Insert each JSON row with its `fields` and `constants`."""
    columns = model.__table__.c
    values = {name: _field(name, columns[name].type) for name in fields} | constants
    return insert(model).from_select(list(values), select(*values.values()).select_from(ROWS))


INSERT_TRIALS: Final = _insert_rows(
    Trial,
    [
        "token",
        "position",
        "kind",
        "part",
        "segment",
        "emotion",
        "speaker",
        "expected",
        "instructed",
        "repeats",
    ],
    {"study_session_id": bindparam("study_session_id", type_=Trial.id.type)},
).returning(Trial.position, Trial.id)
INSERT_VIDEOS: Final = _insert_rows(
    Video, ["trial_id", "number", "token", "duration", "made_from"], {}
).returning(Video.trial_id, Video.number, Video.id)
INSERT_STIMULI: Final = _insert_rows(
    TrialStimulus, ["trial_id", "video_id", "number", "condition", "segment", "speech"], {}
)


def new_token() -> str:
    """Return a random token that nobody can guess."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def draw_tokens(count: int) -> Iterator[str]:
    """Yield `count` random tokens, drawn at once."""
    drawn = secrets.token_urlsafe(TOKEN_BYTES * count)
    for start in range(0, len(drawn), TOKEN_LENGTH):
        yield drawn[start : start + TOKEN_LENGTH]


def store_trials(
    session: Session, study_session_id: int, planned: Sequence[PlannedTrial], served: ServedStudy
) -> None:
    """Store the `planned` trials, their videos and stimuli."""
    connection = session.connection()
    tokens = draw_tokens(sum(1 + len(trial.shown) for trial in planned))

    def as_parameters(rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
        return {"study_session_id": study_session_id, "rows": json.dumps(list(rows))}

    stored = connection.execute(
        INSERT_TRIALS, as_parameters(_trial(trial, next(tokens)) for trial in planned)
    )
    trials: dict[int, int] = dict(stored.all())
    shown = [
        {
            "trial_id": trials[trial.position],
            "number": number,
            "token": next(tokens),
            "duration": served.videos[content].duration,
            "made_from": served.videos[content].made_from,
        }
        for trial in planned
        for number, content in trial.players.items()
    ]
    videos = {
        (trial_id, number): video_id
        for trial_id, number, video_id in connection.execute(INSERT_VIDEOS, as_parameters(shown))
    }
    stimuli = (
        {
            "trial_id": trials[trial.position],
            "video_id": videos[trials[trial.position], player],
            "number": number,
            "condition": stimulus.condition,
            "segment": stimulus.segment,
            "speech": stimulus.speech,
        }
        for trial in planned
        for player, number, stimulus in numbered_stimuli(trial.players)
    )
    connection.execute(INSERT_STIMULI, as_parameters(stimuli))


def _trial(planned: PlannedTrial, token: str) -> dict[str, Any]:
    return {
        "token": token,
        "position": planned.position,
        "kind": planned.kind,
        "part": planned.part,
        "segment": planned.segment.name,
        "emotion": planned.segment.emotion,
        "speaker": planned.segment.speaker,
        "expected": planned.expected,
        "instructed": planned.instructed,
        "repeats": planned.repeats,
    }


def count_votes(session: Session, served: ServedStudy) -> Tally:
    """Count how often each condition was preferred on the study's first question.

    Empty unless the study follows votes. Participants who withdrew, were excluded by hand or took
    part in an earlier design do not vote. Slight and clear preferences count alike, and no
    difference is half a vote for both.
    """
    if not served.study.follows_votes:
        return NO_VOTES
    first, second = aliased(TrialStimulus), aliased(TrialStimulus)
    rows = session.execute(
        select(first.condition, second.condition, Response.value)
        .join(Trial, Trial.id == Response.trial_id)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .join(first, (first.trial_id == Trial.id) & (first.number == 1))
        .join(second, (second.trial_id == Trial.id) & (second.number == 2))
        .where(
            Trial.kind.in_(ANALYSED_KINDS),
            Response.question == served.study.questions[0].name,
            StudySession.withdrawn_at.is_(None),
            tuple_(StudySession.arm, StudySession.arm_design).in_(list(served.arms)),
            StudySession.id.not_in(select(current_exclusions().subquery().c.study_session_id)),
        )
    )
    votes: defaultdict[tuple[str, str], float] = defaultdict(float)
    for a, b, value in rows:
        share = 0.5 if value == 0 else float(value > 0)
        votes[b, a] += share
        votes[a, b] += 1 - share
    return dict(votes)
