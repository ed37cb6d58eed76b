"""Millions of random answers, as a platform's table and in a study's database."""

from typing import Final

import numpy as np
import pandas as pd

SEGMENTS: Final = 48
QUESTIONS: Final = ("synchronisation", "emotion")
CONDITIONS: Final = ("ground_truth", "ours", "baseline", "static")
THRESHOLDS: Final = (-1.6, -0.45, 0.45, 1.6)


def made_table(protocol: str, answers: int, seed: int = 1) -> pd.DataFrame:
    """Return a table of about `answers` rows, earlier conditions being better.

    Parameters
    ----------
    protocol : {'pairwise', 'rating', 'ranking', 'mismatch'}
        Determines the columns.
    answers : int
        Number of rows, rounded up to whole participants, who answer about all segments.
    seed : int
        Seed of all random choices.
    """
    chance = np.random.default_rng(seed)
    shown = len(CONDITIONS) if protocol in ("rating", "ranking") else 1
    each = SEGMENTS * len(QUESTIONS) * shown
    people = -(-answers // each)
    person, segment, question, place = (
        axis.ravel()
        for axis in np.indices((people, SEGMENTS, len(QUESTIONS), shown), dtype=np.int32)
    )
    rows = pd.DataFrame(
        {
            "participant": np.array([f"p{n}" for n in range(people)])[person],
            "segment": np.array([f"s{n}" for n in range(SEGMENTS)])[segment],
            "question": np.array(QUESTIONS)[question],
            "response_seconds": np.round(chance.gamma(6, 4, len(person)), 1),
        }
    )
    taste, luck = chance.normal(0, 0.6, people)[person], chance.normal(0, 0.4, SEGMENTS)[segment]
    names = np.array(CONDITIONS, object)
    match protocol:
        case "pairwise":
            first = chance.integers(0, len(CONDITIONS), len(person))
            second = (first + chance.integers(1, len(CONDITIONS), len(person))) % len(CONDITIONS)
            net = (first - second) * 0.4 * (1 + taste + luck)
            return rows.assign(
                left=names[first], right=names[second], response=_preference(net, chance)
            )
        case "mismatch":
            own_left = chance.random(len(person)) < 0.5
            net = np.where(own_left, -1, 1) * (0.5 + taste + luck)
            return rows.assign(
                condition=names[chance.integers(0, len(CONDITIONS), len(person))],
                left_speech=np.where(own_left, "own", "other"),
                right_speech=np.where(own_left, "other", "own"),
                response=_preference(net, chance),
            )
        case "rating":
            latent = 1 - 0.6 * place + taste + luck
            return rows.assign(condition=names[place], response=_preference(latent, chance))
        case _:
            liking = (-0.5 * place + chance.gumbel(size=len(person))).reshape(-1, shown)
            ranks = np.argsort(np.argsort(-liking, axis=1), axis=1).ravel() + 1
            return rows.assign(condition=names[place], rank=ranks)


def _preference(net: np.ndarray, chance: np.random.Generator) -> np.ndarray:
    return np.digitize(net + chance.logistic(size=len(net)), THRESHOLDS) + 1
