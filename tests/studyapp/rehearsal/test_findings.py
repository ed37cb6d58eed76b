from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import pytest

from studyapp.definition.reading import parse_text
from studyapp.definition.study import Study
from studyapp.design.stimulus import Stimulus
from studyapp.models import (
    Response,
    StudySession,
    StudyVersion,
    Trial,
    TrialStimulus,
    Video,
)
from studyapp.rehearsal.findings import Finding, findings
from studyapp.rehearsal.record import Expected
from studyapp.services.database import Database, sqlite_url
from tests.studyapp.rehearsal.protocol_studies import definition

NOW = datetime(2026, 1, 1, 12, tzinfo=UTC)
CONDITIONS = ["ours", "theirs", "real"]
OURS, THEIRS = (Stimulus.own(name, "one") for name in CONDITIONS[:2])
BROKEN = Stimulus.own("broken", "one")
OURS_ELSEWHERE = Stimulus(condition="ours", segment="one", speech="two")

Shown = tuple[str, Sequence[Stimulus], dict[tuple[str, int | None], int]]
"""Kind of a trial, what it shows, and what was answered."""


def trial(position: int, name: str, kind: str, stimuli: Sequence[Stimulus]) -> Trial:
    made = Trial(
        token=f"{name} {position}",
        position=position,
        kind=kind,
        part="",
        segment="one",
        emotion="",
        speaker="",
        expected=1 if kind == "catch" else None,
        answered_at=NOW,
    )
    video = Video(number=1, token=f"video {name} {position}", duration=1.0)
    made.videos = [video]
    made.stimuli = [
        TrialStimulus(
            number=number,
            condition=stimulus.condition,
            segment=stimulus.segment,
            speech=stimulus.speech,
            video=video,
        )
        for number, stimulus in enumerate(stimuli, start=1)
    ]
    return made


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    with closing(Database.open(sqlite_url(tmp_path / "rehearsal.db"))) as opened:
        yield opened


@pytest.fixture
def sat(database: Database) -> Callable[..., None]:
    """Return a function that stores a study session with the trials it is given."""
    version = StudyVersion(number=1, design="d", definition="", operation={}, opened_at=NOW)
    with database.writing() as session:
        session.add(version)
        session.flush()
        version_id = version.id

    def add(name: str, *shown: Shown, finished: bool = True) -> None:
        trials = [
            trial(position, name, kind, stimuli)
            for position, (kind, stimuli, _) in enumerate(shown, start=1)
        ]
        with database.writing() as session:
            session.add(
                StudySession(
                    token=name,
                    version_id=version_id,
                    arm="all",
                    arm_design="d",
                    conditions=CONDITIONS,
                    consented_at=NOW,
                    last_active_at=NOW,
                    completed_at=NOW if finished else None,
                    completion_code=name if finished else None,
                    trials=trials,
                )
            )
            # Answers refer to stimuli, which must be there before.
            session.flush()
            for made, (_, _, answers) in zip(trials, shown, strict=True):
                made.responses = [
                    Response(question=q, stimulus=n, value=value, reasons=[], answered_at=NOW)
                    for (q, n), value in answers.items()
                ]

    return add


def study(name: str) -> Study:
    return parse_text(definition(name, around=False), where="study.toml")


def found(database: Database, name: str, *expected: Expected) -> dict[tuple[str, str], Finding]:
    rows = findings(database, study(name), expected).rows
    return {(row.measure, row.about): row for row in rows}


def test_wins_are_counted_for_the_condition_that_the_study_names_first(
    database: Database, sat: Callable[..., None]
) -> None:
    sat(
        "p",
        ("main", (OURS, THEIRS), {("fit", None): -2}),
        ("main", (THEIRS, OURS), {("fit", None): 1}),
        ("repeat", (THEIRS, OURS), {("fit", None): 0}),
        ("main", (THEIRS, OURS), {("fit", None): -1}),
    )
    row = found(database, "all pairs")["win_share", "ours-theirs"]
    assert (row.found, row.answers, row.put_in) == (2.5 / 4, 4, None)


def test_the_own_speech_is_counted_on_either_side(
    database: Database, sat: Callable[..., None]
) -> None:
    sat(
        "p",
        ("main", (OURS, OURS_ELSEWHERE), {("better", None): -1}),
        ("main", (OURS_ELSEWHERE, OURS), {("better", None): -1}),
        ("main", (OURS_ELSEWHERE, OURS), {("better", None): 1}),
    )
    assert found(database, "mismatch")["own_speech", "ours"].found == pytest.approx(2 / 3)


@pytest.mark.parametrize(
    ("name", "measure"), [("ratings", "mean_rating"), ("rankings", "mean_rank")]
)
def test_answers_about_single_motions_are_averaged_by_condition(
    database: Database, sat: Callable[..., None], name: str, measure: str
) -> None:
    sat("p", ("main", (OURS, THEIRS), {("q", 1): 4, ("q", 2): 1}))
    sat("r", ("main", (THEIRS, OURS), {("q", 1): 3, ("q", 2): 5}))
    rows = found(database, name)
    assert rows[measure, "ours"].found == 4.5
    assert rows[measure, "theirs"].found == 2.0


def test_practice_checks_and_unfinished_study_sessions_do_not_count(
    database: Database, sat: Callable[..., None]
) -> None:
    sat("begins", ("practice", (OURS, THEIRS), {("fit", None): -2}))
    sat("sees", ("catch", (OURS, BROKEN), {("fit", None): -2}))
    sat("left", ("main", (OURS, THEIRS), {("fit", None): -2}), finished=False)
    assert found(database, "all pairs") == {}


def test_who_fails_too_many_catch_trials_is_left_out_and_counted(
    database: Database, sat: Callable[..., None]
) -> None:
    failed: Shown = ("catch", (OURS, BROKEN), {("fit", None): 2})
    sat("careless", failed, failed, ("main", (OURS, THEIRS), {("fit", None): -2}))
    sat("careful", failed, ("main", (OURS, THEIRS), {("fit", None): 2}))
    result = findings(database, study("all pairs"), ())
    assert result.excluded == 1
    assert [row.found for row in result.rows] == [0.0]


def test_what_was_put_in_stands_beside_what_was_found_in_its_own_order(
    database: Database, sat: Callable[..., None]
) -> None:
    real = Stimulus.own("real", "one")
    sat(
        "p",
        ("main", (OURS, real), {("fit", None): 1}),
        ("main", (OURS, THEIRS), {("fit", None): 1}),
    )
    expected = [
        Expected(
            question="fit",
            measure="win_share",
            about=about,
            value=0.5,
            value_on_these_segments=share,
        )
        for about, share in (("ours-theirs", 0.4), ("ours-real", 0.7), ("theirs-real", 0.8))
    ]
    rows = findings(database, study("all pairs"), expected).rows
    assert [(row.about, row.put_in) for row in rows] == [("ours-theirs", 0.4), ("ours-real", 0.7)]
