"""The page of results, in Markdown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

import numpy as np

from analysis.evaluators import network_names as names
from analysis.measurement.scores import StudyMetrics
from analysis.metrics.result import EmotionConfusion
from benchmarks.learned_motion.comparison import Followings, Verdict, score_of, written
from benchmarks.learned_motion.editing import BY_NAME, BY_RECORDING, Edited
from studyapp.study.settings.study import GROUND_TRUTH

SCORES: Final = (
    ("FGD ↓", names.FGD),
    ("FED ↓", names.FED),
    ("KID of gestures ↓", names.kernel_of(names.GESTURE)),
    ("L1div, m", "deviation from the mean pose"),
    ("variance of gesture features", f"variance of features ({names.GESTURE})"),
    ("beat alignment − chance", "beat alignment above chance (amuse)"),
    ("emotion named", "gesture emotion accuracy"),
)
"""Columns, and how the metric's name begins."""

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
"""What is told of a speech model, and the titles of columns."""


@dataclass(frozen=True, kw_only=True)
class Findings:
    """All that is measured.

    Attributes
    ----------
    metrics : StudyMetrics
        Of all conditions.
    followed : mapping of condition to Followings
        In the order of the tables.
    judged : mapping of system to sequence of Verdict
        What is asked of trained networks.
    heard : mapping of condition to mapping
        What speech models hear apart; see `heard_apart`.
    edited : mapping of str to mapping of condition to Edited
        What edits of the emotion do, by `BY_NAME` and `BY_RECORDING`.
    """

    metrics: StudyMetrics
    followed: Mapping[str, Followings]
    judged: Mapping[str, Sequence[Verdict]]
    heard: Mapping[str, Mapping[str, float]]
    edited: Mapping[str, Mapping[str, Edited]]


def page(findings: Findings, facts: Sequence[str]) -> str:
    """Return the page of all findings; `facts` are sentences that say how they were made."""
    metrics = findings.metrics
    return "\n".join(
        [
            "# Learned motion beside the truth",
            "",
            "Made by `make bench-learned-motion`; written anew by every run.",
            "",
            "Networks learn from the synthetic corpus (docs/corpus.md), whose motion comes from a "
            "known process, and move to speech that they never heard. `diffsheg_1` and so on are "
            "tiny configs from different seeds; `untrained` is DiffSHEG's network with its first "
            "weights; `mismatched` is recorded motion of other takes. `amuse_without_alignment_1` "
            "and so on are AMUSE's ablations (docs/amuse.md).",
            "",
            "## Automatic metrics",
            "",
            *_table(
                ("condition", *(title for title, _ in SCORES)),
                [
                    [
                        condition,
                        *(_number(score_of(metrics, condition, name)) for _, name in SCORES),
                    ]
                    for condition in findings.followed
                ],
            ),
            "",
            "`ground_truth` has no distance from itself. The distance of `mismatched` is near zero "
            "by construction: it is the same recorded motion, given to other speech, and a "
            "distance between distributions never looks at the speech. Diversity and variance are "
            "best near those of `ground_truth`.",
            "",
            "## Does the motion follow its speech?",
            "",
            "Correlation of each clip's wrist speed and jaw with what the process makes of the "
            "speech without chance, and beat alignment minus chance: with the clip's own speech, "
            "and with that of another take. Stroke alignment is beat alignment with the times at "
            "which the process lets strokes arrive in place of the onsets of sounds. The first and "
            "the last second, silent and at rest in all takes, do not count. 95% intervals over "
            "takes, those of one text by one speaker drawn together. Recorded motion, of which the "
            "process also leaves much to chance, shows how much there is to be had. Of beat "
            "alignment it is little: about four sounds begin in a second and a third of them has a "
            "stroke, so that an onset is near wherever a hand rests.",
            "",
            *_table(
                (
                    "condition",
                    *(f"{title}, {whose}" for _, title in FOLLOWED for whose in ("own", "swapped")),
                ),
                [
                    [
                        condition,
                        *(
                            written(side[measure])
                            for measure, _ in FOLLOWED
                            for side in (entry.own, entry.swapped)
                        ),
                    ]
                    for condition, entry in findings.followed.items()
                ],
            ),
            "",
            "## What is asked of a trained network",
            "",
            *_table(
                ("system", "claim", "all seeds", "numbers"),
                [
                    [system, entry.claim, "yes" if entry.holds else "**no**", entry.evidence]
                    for system, judged in findings.judged.items()
                    for entry in judged
                ],
            ),
            "",
            *_heard(findings.heard),
            *(line for way, edited in findings.edited.items() for line in _edited(way, edited)),
            "Spoken and named, recorded test takes:",
            "",
            *(
                line
                for entry in metrics.confusions
                if entry.condition == GROUND_TRUTH
                for line in _confusion(entry)
            ),
            "",
            "## How",
            "",
            *(f"- {fact}" for fact in facts),
            "",
        ]
    )


def _heard(heard: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Return what speech models hear apart, as Tables A.1 and A.2 of AMUSE's paper show it."""
    return [
        "## What AMUSE's speech models hear apart",
        "",
        "Of the test takes' windows. Chance names one emotion of eight and one speaker of six. "
        "Errors are mean absolute differences of standardised filterbanks: rebuilt from their own "
        "latents, and with one latent of another of the same four recordings.",
        "",
        *_table(
            ("speech model of", *HEARD.values()),
            [[name, *(_number(entry[key]) for key in HEARD)] for name, entry in heard.items()],
        ),
        "",
    ]


GIVEN: Final = MappingProxyType(
    {
        BY_NAME: "the mean latent of one of the other seven emotions",
        BY_RECORDING: "the emotion that it hears in another test take, in which the same speaker "
        "says something else in one of the other seven emotions",
    }
)
"""What stands in for a speech's own emotion."""


def _edited(way: str, edited: Mapping[str, Edited]) -> list[str]:
    """Return what edits do, and the confusion of Figure A.12, counts of all seeds."""
    counts = sum(np.array(entry.confusion.counts) for entry in edited.values())
    recognised = next(iter(edited.values())).confusion
    everything = replace(recognised, counts=tuple(map(tuple, np.asarray(counts).tolist())))
    return [
        f"## Another emotion {way}",
        "",
        f"Each edit keeps the speech and its noise, and gives AMUSE {GIVEN[way]}. Named: the share "
        "that a classifier of recorded motion takes for the emotion that was given. Speaker: the "
        "share that a second one takes for their own speaker. Wrists: correlation of their speed "
        "before and after the edit.",
        "",
        *_table(
            (
                "condition",
                "emotion named",
                "speaker, unedited",
                "speaker, edited",
                "wrists",
                "stroke alignment − chance, unedited",
                "stroke alignment − chance, edited",
            ),
            [
                [
                    name,
                    _number(entry.accuracy),
                    _number(entry.speaker_before),
                    _number(entry.speaker_after),
                    _number(entry.speed),
                    written(entry.strokes_before),
                    written(entry.strokes_after),
                ]
                for name, entry in edited.items()
            ],
        ),
        "",
        "Given (rows) and named (columns), edits of all seeds:",
        "",
        *_confusion(everything),
        "",
    ]


def _confusion(confusion: EmotionConfusion) -> list[str]:
    rows = zip(confusion.spoken, confusion.counts, strict=True)
    return _table(
        ("", *confusion.named), [[recognised, *map(str, counts)] for recognised, counts in rows]
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [
        f"| {' | '.join(head)} |",
        f"|{'---|' * len(head)}",
        *(f"| {' | '.join(row)} |" for row in rows),
    ]


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.3g}"
