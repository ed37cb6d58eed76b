"""Study definitions and segments for tests, without any file."""

from collections.abc import Sequence
from typing import Any

from motion.segment import Segment
from studyapp.study.design.trial import PlannedTrial
from studyapp.study.protocols.pairwise import PairwiseStudy

CODES = {"completed": "KX7QM2PWTR", "screened_out": "HB4NVJ9ZCD", "failed_attention": "WU3FGRE8KA"}
"""A completion code on Prolific for each outcome."""


def make_study(**changes: Any) -> PairwiseStudy:
    """Return a study of two comparisons; `changes` replace top-level keys of its file."""
    keys: dict[str, Any] = {
        "name": "made",
        "title": "Made study",
        "reference": "rule_based",
        "conditions": {"rule_based": {}, "mismatched": {}, "static": {}},
        "questions": [
            {"name": "rhythm", "title": "Rhythm", "text": "Which fits better?"},
            {"name": "emotion", "title": "Emotion", "text": "Which shows {emotion} better?"},
        ],
        "page": {"consent": "You agree."},
    }
    return PairwiseStudy.model_validate(keys | changes)


def make_segments(emotions: Sequence[str]) -> tuple[Segment, ...]:
    """Return one segment per given emotion, in order."""
    return tuple(
        Segment(
            name=f"segment-{index}",
            wav="take.wav",
            start=float(index),
            end=index + 1.0,
            speaker="robin",
            emotion=emotion,
        )
        for index, emotion in enumerate(emotions)
    )


def pair_plan(
    study: PairwiseStudy, segments: Sequence[Segment], *, other: str, number: int
) -> tuple[PlannedTrial, ...]:
    """Return the trials of one place of the comparison of the reference with `other`."""
    (arm,) = (arm for arm in study.arms if arm.conditions == (study.reference, other))
    return study.plan(arm, number, segments)
