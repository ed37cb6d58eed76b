"""Tables as other platforms write them, with a known truth."""

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.answers.reading import read_answers
from analysis.answers.table import LAYOUTS, AnswerTable
from analysis.results.report import TableReport, analyse_table

THRESHOLDS = (-1.6, -0.45, 0.45, 1.6)


def pairwise_table(
    conditions: Sequence[str] = ("ours", "other", "static"),
    questions: Sequence[str] = ("emotion",),
    *,
    participants: int = 12,
    segments: int = 6,
    effects: Sequence[float] = (1.2, 0.6, 0.0),
    seed: int = 1,
) -> pd.DataFrame:
    """Every participant compares every pair in every segment; the first two come back."""
    chance = np.random.default_rng(seed)
    strength = dict(zip(conditions, effects, strict=True))
    taste = chance.normal(0, 0.5, participants)
    rows = []
    for person in range(participants):
        trials = [
            ("practice" if segment < 2 else "main", segment, pair)
            for segment in range(segments)
            for pair in combinations(conditions, 2)
        ]
        trials += [("repeat", segment, pair) for kind, segment, pair in trials if kind != "main"]
        for trial, (kind, segment, (a, b)) in enumerate(trials, start=1):
            left, right = (a, b) if chance.random() < 0.5 else (b, a)
            net = strength[right] - strength[left]
            net *= 1 + taste[person]
            for question in questions:
                answer = int(np.digitize(net + chance.logistic(), THRESHOLDS)) + 1
                rows.append(
                    (f"p{person:02d}", f"s{segment}", question, trial, kind, left, right, answer)
                )
    header = ["participant", "segment", "question", "trial", "kind", "left", "right", "response"]
    return pd.DataFrame(rows, columns=header)


def catch_rows(participant: str, sides: str, answers: Sequence[int]) -> pd.DataFrame:
    """One catch trial a side ('l' or 'r'), one question each."""
    return pd.DataFrame(
        {
            "participant": participant,
            "segment": "s0",
            "question": "emotion",
            "trial": [f"c{number}" for number in range(len(sides))],
            "kind": "catch",
            "left": ["ours" if side == "l" else "broken" for side in sides],
            "right": ["ours" if side == "r" else "broken" for side in sides],
            "response": list(answers),
            "correct_side": ["left" if side == "l" else "right" for side in sides],
        }
    )


def crossed(participants: int, segments: int, **others: Sequence[str]) -> pd.DataFrame:
    """Return a row for everything that every participant answers in every segment."""
    names = {
        "participant": [f"p{number:02d}" for number in range(participants)],
        "segment": [f"s{number}" for number in range(segments)],
        **others,
    }
    return pd.MultiIndex.from_product(list(names.values()), names=list(names)).to_frame(index=False)


def rating_table(
    conditions: Sequence[str] = ("truth", "ours", "static"),
    questions: Sequence[str] = ("match",),
    *,
    participants: int = 12,
    segments: int = 6,
    seed: int = 1,
) -> pd.DataFrame:
    """Every participant rates every condition in every segment; earlier conditions are better."""
    chance = np.random.default_rng(seed)
    mood = chance.normal(0, 0.7, participants)[:, None, None, None]
    shape = (participants, segments, len(conditions), len(questions))
    better = 1.0 - 1.2 * np.arange(len(conditions))[:, None]
    answers = np.digitize(mood + better + chance.logistic(size=shape), THRESHOLDS) + 1
    table = crossed(participants, segments, condition=conditions, question=questions)
    return table.assign(response=answers.ravel())


def ranking_table(
    conditions: Sequence[str] = ("truth", "ours", "static"),
    *,
    participants: int = 12,
    segments: int = 6,
    seed: int = 1,
) -> pd.DataFrame:
    """Every participant ranks all conditions of every segment; earlier conditions are better."""
    chance = np.random.default_rng(seed)
    shape = (participants, segments, len(conditions))
    liking = -0.8 * np.arange(len(conditions)) + chance.gumbel(size=shape)
    table = crossed(participants, segments, condition=conditions)
    return table.assign(question="realism", rank=1 + np.argsort(np.argsort(-liking)).ravel())


def mismatch_table(
    conditions: Sequence[str] = ("truth", "static"),
    *,
    participants: int = 12,
    segments: int = 6,
    seed: int = 1,
) -> pd.DataFrame:
    """Own speech is preferred in the first condition and makes no difference in the second."""
    chance = np.random.default_rng(seed)
    table = crossed(participants, segments, condition=conditions)
    own_right = chance.random(len(table)) < 0.5
    net = np.where(table["condition"] == conditions[0], np.where(own_right, 1.0, -1.0), 0.0)
    return table.assign(
        question="fits",
        left_speech=np.where(own_right, "other", "own"),
        right_speech=np.where(own_right, "own", "other"),
        response=np.digitize(net + chance.logistic(size=len(table)), THRESHOLDS) + 1,
    )


TABLES = {
    "pairwise": pairwise_table,
    "rating": rating_table,
    "ranking": ranking_table,
    "mismatch": mismatch_table,
}


def one_answer_everywhere(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table with everything in the middle, or in the first place."""
    return table.assign(**({"rank": 1} if "rank" in table else {"response": 3}))


def read_table(
    table: pd.DataFrame, protocol: str, folder: Path, scale: tuple[int, int] | None = None
) -> AnswerTable:
    """Write a table as CSV and read it."""
    path = folder / "answers.csv"
    table.to_csv(path, index=False)
    return read_answers(path, LAYOUTS[protocol], scale)


def report_of(table: pd.DataFrame, protocol: str, folder: Path, **settings: Any) -> TableReport:
    """Analyse a table as the command line does."""
    path = folder / "answers.csv"
    table.to_csv(path, index=False)
    return analyse_table(path, protocol, **settings)
