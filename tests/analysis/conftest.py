"""Studies with known answers, for the tests of the analysis."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.responses import responses_frame
from motion.segment import EMOTIONS, Segment

Row = dict[str, Any]

BASE: Row = {
    "study_session": "s1",
    "comparison": "ours_vs_other",
    "reference": "ours",
    "other": "other",
    "segment": "a",
    "emotion": "anger",
    "speaker": "scott",
    "kind": "main",
    "position": 1,
    "question": "synchronisation",
    "left_condition": "ours",
    "right_condition": "other",
    "value": 0,
    "expected": "",
    "seconds": 20.0,
    "watched": 1.0,
    "answered_at": "2026-11-21T09:00:00+00:00",
}

QUESTIONS = {
    "synchronisation": "In which video do the gestures fit the rhythm of the speech better?",
    "emotion": "The speaker feels {emotion}. In which video do the gestures show it better?",
}


@pytest.fixture
def answer() -> Callable[..., Row]:
    """Return a maker of valid rows; keywords replace columns."""
    return lambda **columns: BASE | columns


@dataclass(frozen=True, kw_only=True)
class SimulatedStudy:
    """A study of raters whose preferences are known, in logits per condition and question."""

    reference: str = "rule_based"
    effects: Mapping[str, float] = field(default_factory=lambda: {"mismatched": 0.7, "static": 1.6})
    participants: int = 25
    segments: int = 24
    practice: int = 3
    catch: int = 3
    inattentive: int = 3
    unfinished: int = 1
    seed: int = 1

    def segment(self, number: int) -> Segment:
        emotion = EMOTIONS[number % len(EMOTIONS)]
        return Segment(
            name=f"segment{number:02d}",
            wav="speech.wav",
            start=10.0 * number,
            end=10.0 * (number + 1),
            speaker="scott" if number % 2 else "wayne",
            emotion=emotion,
        )

    def responses(self) -> pd.DataFrame:
        generator = np.random.default_rng(self.seed)
        item_luck = generator.normal(0, 0.45, (len(self.effects), self.segments))
        rows: list[Row] = []
        for number, (other, effect) in enumerate(self.effects.items()):
            for person in range(self.participants):
                rows += self._session(generator, other, effect, person, item_luck[number])
        return responses_frame(rows)

    def _session(
        self,
        generator: np.random.Generator,
        other: str,
        effect: float,
        person: int,
        luck: np.ndarray,
    ) -> list[Row]:
        order = generator.permutation(self.segments).tolist()
        trials = [("practice", k) for k in order[: self.practice]]
        trials += [("main", k) for k in order[self.practice :]]
        trials += [("repeat", k) for k in order[: self.practice]]
        for _ in range(self.catch):
            trials.insert(int(generator.integers(self.practice, len(trials))), ("catch", order[-1]))
        if person < self.unfinished:
            trials = trials[: len(trials) // 2]
        attentive = person >= self.unfinished + self.inattentive
        taste = generator.normal(0, 0.6)
        rows: list[Row] = []
        for position, (kind, k) in enumerate(trials, start=1):
            left_first = bool(generator.random() < 0.5)
            shown = (self.reference, "broken" if kind == "catch" else other)
            left, right = shown if left_first else shown[::-1]
            for question in QUESTIONS:
                strength = (effect + taste + luck[k]) if kind != "catch" else 6.0
                latent = strength * attentive + generator.logistic()
                towards = int(np.sign(latent) * np.searchsorted((0.45, 1.6), abs(latent)))
                rows.append(
                    BASE
                    | {
                        "study_session": f"{other}-{person:02d}",
                        "comparison": f"{self.reference}_vs_{other}",
                        "reference": self.reference,
                        "other": shown[1],
                        "segment": self.segment(k).name,
                        "emotion": self.segment(k).emotion,
                        "speaker": self.segment(k).speaker,
                        "kind": kind,
                        "position": position,
                        "question": question,
                        "left_condition": left,
                        "right_condition": right,
                        "value": -towards if left_first else towards,
                        "expected": ("left" if left_first else "right") * (kind == "catch"),
                        "seconds": round(float(generator.uniform(22, 60)), 2),
                        "watched": 0.98,
                    }
                )
        return rows


@pytest.fixture
def simulated_study() -> type[SimulatedStudy]:
    """Return the maker of simulated studies."""
    return SimulatedStudy
