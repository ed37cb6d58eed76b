"""The page of results, in Markdown."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

import numpy as np

from analysis.evaluators import feature_networks as names
from analysis.metrics.scores import EmotionConfusion, StudyMetrics
from benchmarks.learned_motion.comparison import Followings, Verdict, score_of, written
from benchmarks.learned_motion.editing import BY_NAME, BY_RECORDING, Edited
from studyapp.study.settings.study import GROUND_TRUTH
from tools.markdown import rendered, table

SCORES: Final = (
    ("FGD ↓", names.FGD),
    ("FED ↓", names.FED),
    ("KID of gestures ↓", names.kernel_of(names.GESTURE)),
    ("L1div, m", "deviation from the mean pose"),
    ("variance of gesture features", f"variance of features ({names.GESTURE})"),
    ("beat alignment − chance", "beat alignment above chance (amuse)"),
    ("emotion named", "gesture emotion accuracy"),
)
"""Columns, and beginnings of the metrics' names."""

FOLLOWED: Final = (
    ("wrist_speed", "wrist speed"),
    ("jaw_open", "jaw"),
    ("beats", "beat alignment − chance"),
    ("strokes", "stroke alignment − chance"),
)


HEARD: Final = MappingProxyType(
    {
        "emotion accuracy": "emotion",
        "emotion F1": "F1",
        "style accuracy": "speaker",
        "style F1": "F1",
        "self of fours": "own latents",
        "xcon": "another's content",
        "xemo": "another's emotion",
        "xsty": "another's style",
    }
)
"""Results of a speech model, and the titles of their columns."""


@dataclass(frozen=True, kw_only=True)
class Findings:
    """All measurements.

    Attributes
    ----------
    metrics : StudyMetrics
        Metrics of all conditions.
    followed : mapping of condition to Followings
        How well they follow speech, in the order of the tables.
    judged : mapping of system to sequence of Verdict
        Requirements for trained networks.
    heard : mapping of condition to mapping
        What speech models distinguish; see `heard_apart`.
    edited : mapping of str to mapping of condition to Edited
        Effects of edits of the emotion, by `BY_NAME` and `BY_RECORDING`.
    """

    metrics: StudyMetrics
    followed: Mapping[str, Followings]
    judged: Mapping[str, Sequence[Verdict]]
    heard: Mapping[str, Mapping[str, float]]
    edited: Mapping[str, Mapping[str, Edited]]


def page(findings: Findings, facts: Sequence[str]) -> str:
    """Return the page of all findings; `facts` are sentences on how they were made."""
    metrics, heard = findings.metrics, findings.heard
    sides = [f"{title}, {whose}" for _, title in FOLLOWED for whose in ("own", "swapped")]
    return rendered(
        "benchmarks.learned_motion",
        "learned_motion.md",
        scores=table(
            ("condition", *(title for title, _ in SCORES)),
            [
                (condition, *(_number(score_of(metrics, condition, name)) for _, name in SCORES))
                for condition in findings.followed
            ],
        ),
        followed=table(
            ("condition", *sides),
            [
                (
                    condition,
                    *(
                        written(side[measure])
                        for measure, _ in FOLLOWED
                        for side in (entry.own, entry.swapped)
                    ),
                )
                for condition, entry in findings.followed.items()
            ],
        ),
        judged=table(
            ("system", "claim", "all seeds", "numbers"),
            [
                (system, entry.claim, "yes" if entry.holds else "**no**", entry.evidence)
                for system, judged in findings.judged.items()
                for entry in judged
            ],
        ),
        heard=table(
            ("speech model of", *HEARD.values()),
            [(name, *(_number(entry[key]) for key in HEARD)) for name, entry in heard.items()],
        ),
        edits=[
            (way, GIVEN[way], _edited(edited), _of_all_seeds(edited))
            for way, edited in findings.edited.items()
        ],
        recorded=[
            _confusion(entry) for entry in metrics.confusions if entry.condition == GROUND_TRUTH
        ],
        facts=facts,
    )


GIVEN: Final = MappingProxyType(
    {
        BY_NAME: "the mean latent of one of the other seven emotions",
        BY_RECORDING: "the emotion that it hears in another test take, in which the same speaker "
        "says something else in one of the other seven emotions",
    }
)
"""What replaces the emotion of the speech."""


def _edited(edited: Mapping[str, Edited]) -> str:
    head = (
        "condition",
        "emotion named",
        "speaker, unedited",
        "speaker, edited",
        "wrists",
        "stroke alignment − chance, unedited",
        "stroke alignment − chance, edited",
    )
    rows = []
    for name, entry in edited.items():
        shares = (entry.accuracy, entry.speaker_before, entry.speaker_after, entry.speed)
        strokes = (entry.strokes_before, entry.strokes_after)
        rows.append((name, *map(_number, shares), *map(written, strokes)))
    return table(head, rows)


def _of_all_seeds(edited: Mapping[str, Edited]) -> str:
    """Return the confusion of Figure A.12, summed over seeds."""
    counts = sum(np.array(entry.confusion.counts) for entry in edited.values())
    recognised = next(iter(edited.values())).confusion
    return _confusion(replace(recognised, counts=tuple(map(tuple, np.asarray(counts).tolist()))))


def _confusion(confusion: EmotionConfusion) -> str:
    rows = zip(confusion.spoken, confusion.counts, strict=True)
    return table(("", *confusion.named), [(name, *map(str, counts)) for name, counts in rows])


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.3g}"
