"""A study of every protocol, and answers that an attentive or a careless participant gives."""

from collections.abc import Sequence
from typing import Any

from motion.segment import Segment
from studyapp.study.design.trial import AnswerKey, Ask, Trial
from studyapp.study.settings.questions import RatingQuestion
from studyapp.study.settings.reading import parse_study
from studyapp.study.settings.study import Study

CONDITIONS: dict[str, dict[str, str]] = {name: {} for name in ("ours", "theirs", "static", "real")}
LABELS = ["one", "two", "three", "four", "five"]


def question(name: str, **more: Any) -> dict[str, Any]:
    return {"name": name, "title": name, "text": f"About {name}?", **more}


KEYS: dict[str, dict[str, Any]] = {
    "pairwise": {
        "reference": "ours",
        "trials": 6,
        "practice": 2,
        "questions": [
            question("rhythm"),
            question("emotion", reasons=[{"name": "timing", "text": "The timing"}]),
        ],
    },
    "all_pairs": {
        "protocol": "pairwise",
        "comparisons": "all_pairs",
        "reference": "ours",
        "trials": 12,
        "questions": [question("rhythm")],
    },
    "adaptive": {
        "protocol": "pairwise",
        "comparisons": "adaptive",
        "reference": "ours",
        "layout": "players",
        "trials": 6,
        "questions": [question("rhythm")],
    },
    "rating": {
        "sets": [
            {"name": "four", "conditions": ["ours", "theirs", "static", "real"], "groups": 4},
            {"name": "three", "conditions": ["ours", "theirs", "real"], "groups": 3},
        ],
        "questions": [
            question("naturalness", labels=LABELS),
            question("quality", scale="mean_opinion"),
            question("synchrony", scale="slider", parts=["three"]),
        ],
    },
    "ranking": {
        "reference": "real",
        "blocks": [
            {"name": "long", "conditions": ["ours", "theirs", "static"], "trials": 3},
            {"name": "short", "conditions": ["ours", "theirs"], "trials": 4},
        ],
        "catch": {"trials": 0, "against": "ours"},
        "questions": [question("realism"), question("diversity")],
    },
    "mismatch": {
        "fit": 7,
        "realism": 5,
        "questions": [
            question("fit", parts=["fit"], levels=3),
            question("realism", parts=["realism"], levels=2),
        ],
    },
}
"""The keys of each protocol's study file, added to the common ones."""


def make(protocol: str, **changes: Any) -> Study:
    """Return a study of `protocol`; `changes` replace top-level keys of its file."""
    keys = {
        "name": "made",
        "title": "Made study",
        "protocol": protocol,
        "conditions": CONDITIONS,
        "page": {"consent": "You agree."},
    }
    return parse_study({**keys, **KEYS[protocol], **changes}, where="test")


def lasting(*seconds: float) -> list[Segment]:
    """Return segments of these durations."""
    return [
        Segment(name=f"s{index}", wav="a.wav", start=0.0, end=end, speaker="", emotion="neutral")
        for index, end in enumerate(seconds)
    ]


def in_order(study: Study, trial: Trial, order: Sequence[int]) -> dict[AnswerKey, int]:
    """Return answers that put the stimuli of `trial` in `order`, the best first."""
    return {ask.key: _value(study, ask, order) for ask in study.asks(trial)}


def obedient(study: Study, trial: Trial) -> dict[AnswerKey, int]:
    """Return the answers that an attention check asks for."""
    wanted = trial.instructed
    assert wanted is not None
    if study.protocol == "ranking":
        rest = [number for number in range(1, len(trial.conditions) + 1) if number != wanted]
        return in_order(study, trial, [wanted, *rest])
    return {
        ask.key: next(value for value in ask.values if _step(study, ask, value) == wanted)
        for ask in study.asks(trial)
    }


def _step(study: Study, ask: Ask, value: int) -> int:
    asked = next(question for question in study.questions if question.name == ask.question)
    return asked.step(value) if isinstance(asked, RatingQuestion) else value


def _value(study: Study, ask: Ask, order: Sequence[int]) -> int:
    if ask.stimulus is None:
        return min(ask.values) if order[0] == 1 else max(ask.values)
    place = order.index(ask.stimulus)
    if study.protocol == "ranking":
        return place + 1
    spread = (max(ask.values) - min(ask.values)) // max(1, len(order) - 1)
    return max(ask.values) - place * spread
