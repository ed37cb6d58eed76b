"""A study whose database holds very many answers, written in bulk."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np
import soundfile
from sqlalchemy import Connection, Table, create_engine, insert

from benchmarks.report.made_answers import CONDITIONS, QUESTIONS, THRESHOLDS
from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables.study_session import StudySession, StudyVersion
from studyapp.database.tables.trial import Response, Trial, TrialStimulus, Video, WatchRecord
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.reading import parse_text
from studyapp.study.versioning import operation_part

TRIALS: Final = 48
SECONDS: Final = 6.0
RATE: Final = 8000
"""Samples per second of the recording, which is silent: nobody listens."""

NOON: Final = datetime(2026, 1, 1, 12, tzinfo=UTC)
ROWS: Final = 100_000
"""Rows per insert."""

_QUESTION: Final = '[[questions]]\nname = "{name}"\ntitle = "{name}"\ntext = "Which is better?"\n'

STUDY_FILE: Final = f"""\
name = "filled"
title = "Very many answers"
protocol = "pairwise"
comparisons = "all_pairs"
layout = "players"
reference = "{CONDITIONS[0]}"
trials = {TRIALS}
practice = 0
catch = {{ trials = 0 }}

{"".join(f"[conditions.{name}]{chr(10)}videos = true{chr(10)}" for name in CONDITIONS)}
{"".join(_QUESTION.format(name=name) for name in QUESTIONS)}
[page]
consent = "You agree."
"""

SEGMENTS_FILE: Final = "name,wav,start,end,speaker,emotion,transcript\n" + "".join(
    f"s{number:02},speech.wav,{number * 10},{number * 10 + SECONDS},one,neutral,\n"
    for number in range(TRIALS)
)


def fill_study(root: Path, answers: int, seed: int = 1) -> None:
    """Write a pairwise study of two players a page into `root`, with about `answers` answers.

    Everybody has watched both videos of every trial.
    """
    (root / "study.toml").write_text(STUDY_FILE, "utf-8")
    (root / "speech").mkdir(parents=True)
    (root / "speech" / "segments.csv").write_text(SEGMENTS_FILE, "utf-8")
    silence = np.zeros(TRIALS * 10 * RATE, np.float32)
    soundfile.write(root / "speech" / "speech.wav", silence, RATE)
    url = sqlite_url(StudyFolder(root).responses)
    Database.open(url).close()
    chance = np.random.default_rng(seed)
    people = -(-answers // (TRIALS * len(QUESTIONS)))
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(insert(_table(StudyVersion)), _version())
        _write(connection, StudySession, [_study_session(person) for person in range(people)])
        for first in range(0, people, 250):
            _write_trials(connection, range(first, min(first + 250, people)), chance)
    engine.dispose()


def _version() -> dict[str, Any]:
    return {
        "id": 1,
        "number": 1,
        "design": "filled",
        "definition": STUDY_FILE,
        "operation": operation_part(parse_text(STUDY_FILE, where="the benchmark's study")),
        "opened_at": NOON,
    }


def _study_session(person: int) -> dict[str, Any]:
    return {
        "id": person + 1,
        "token": f"participant-{person}",
        "version_id": 1,
        "arm": "all",
        "arm_design": "filled",
        "number": person,
        "conditions": list(CONDITIONS),
        "consented_at": NOON,
        "started_at": NOON,
        "last_active_at": NOON,
        "completed_at": NOON,
        "completion_code": f"code-{person}",
    }


def _write_trials(connection: Connection, people: range, chance: np.random.Generator) -> None:
    """Write the trials of some people with their videos and answers."""
    first = people.start * TRIALS
    count = len(people) * TRIALS
    left = chance.integers(0, len(CONDITIONS), count)
    right = (left + chance.integers(1, len(CONDITIONS), count)) % len(CONDITIONS)
    taste = np.repeat(chance.normal(0, 0.6, len(people)), TRIALS)
    net = (left - right) * 0.4 * (1 + taste)
    simulated_answers = [
        np.digitize(net + chance.logistic(size=count), THRESHOLDS) - 2 for _ in QUESTIONS
    ]
    seconds = chance.gamma(6, 4, count).round(2)
    trials, videos, stimuli, responses, records = [], [], [], [], []
    for index in range(count):
        trial = first + index + 1
        position = index % TRIALS
        segment = f"s{position:02}"
        trials.append(
            {
                "id": trial,
                "study_session_id": people.start + index // TRIALS + 1,
                "token": f"trial-{trial}",
                "position": position + 1,
                "kind": "main",
                "segment": segment,
                "emotion": "neutral",
                "speaker": "one",
                "shown_at": NOON,
                "answered_at": NOON,
                "seconds": float(seconds[index]),
            }
        )
        for number, shown in ((1, left[index]), (2, right[index])):
            video = 2 * trial + number - 2
            videos.append(
                {
                    "id": video,
                    "trial_id": trial,
                    "number": number,
                    "token": f"video-{video}",
                    "duration": SECONDS,
                    "sent_at": NOON,
                }
            )
            stimuli.append(
                {
                    "trial_id": trial,
                    "video_id": video,
                    "number": number,
                    "condition": CONDITIONS[shown],
                    "segment": segment,
                    "speech": segment,
                }
            )
            records.append(
                {
                    "video_id": video,
                    "intervals": [[0.0, SECONDS]],
                    "played_seconds": SECONDS,
                    "rate": 1.0,
                    "hidden_seconds": 0.0,
                    "silent_seconds": 0.0,
                    "stalls": 0,
                    "stalled_seconds": 0.0,
                    "latest": [[0, 0]],
                    "reported_at": NOON,
                }
            )
        responses += [
            {
                "trial_id": trial,
                "question": question,
                "value": int(values[index]),
                "reasons": [],
                "answered_at": NOON,
            }
            for question, values in zip(QUESTIONS, simulated_answers, strict=True)
        ]
    for model, rows in (
        (Trial, trials),
        (Video, videos),
        (TrialStimulus, stimuli),
        (Response, responses),
        (WatchRecord, records),
    ):
        _write(connection, model, rows)


def _write(connection: Connection, model: type, rows: list[dict[str, Any]]) -> None:
    for start in range(0, len(rows), ROWS):
        connection.execute(insert(_table(model)), rows[start : start + ROWS])


def _table(model: type) -> Table:
    found = model.__table__  # type: ignore[attr-defined]
    assert isinstance(found, Table)  # noqa: S101 - what SQLAlchemy's models always have
    return found
