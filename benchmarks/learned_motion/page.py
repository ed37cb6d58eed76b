"""The page of results, in Markdown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from analysis.metrics import network_names as names
from analysis.metrics.conditions import StudyMetrics
from benchmarks.learned_motion.comparison import Followings, Verdict, score_of, written

SCORES: Final = (
    ("FGD ↓", names.FGD),
    ("FED ↓", names.FED),
    ("KID of gestures ↓", names.kernel_of(names.GESTURE)),
    ("L1div, m", "deviation from the mean pose"),
    ("variance of gesture features", f"variance of features ({names.GESTURE})"),
    ("beat alignment − chance", "beat alignment above chance (amuse)"),
)
"""Columns, and how the metric's name begins."""

FOLLOWED: Final = (
    ("wrist_speed", "wrist speed"),
    ("jaw_open", "jaw"),
    ("beats", "beat alignment − chance"),
    ("strokes", "stroke alignment − chance"),
)


def page(
    metrics: StudyMetrics,
    found: Mapping[str, Followings],
    judged: Sequence[Verdict],
    facts: Sequence[str],
) -> str:
    """Return the page.

    Parameters
    ----------
    metrics : StudyMetrics
        Of all conditions.
    found : mapping of condition to Followings
        In the order of the tables.
    judged : sequence of Verdict
        What is asked of trained networks.
    facts : sequence of str
        Sentences that say how the numbers were made.
    """
    return "\n".join(
        [
            "# Learned motion beside the truth",
            "",
            "Made by `make bench-learned-motion`; written anew by every run.",
            "",
            "Networks learn from the synthetic corpus (docs/corpus.md), whose motion comes from a "
            "known process, and move to speech that they never heard. `trained_1` and so on are "
            "DiffSHEG's tiny config from different seeds; `untrained` is the same network with its "
            "first weights; `mismatched` is recorded motion of other takes.",
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
                    for condition in found
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
            "the last second, silent and at rest in all takes, do not count. 95 % intervals over "
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
                            for side in (one.own, one.swapped)
                        ),
                    ]
                    for condition, one in found.items()
                ],
            ),
            "",
            "## What is asked of a trained network",
            "",
            *_table(
                ("claim", "all seeds", "numbers"),
                [[one.claim, "yes" if one.holds else "**no**", one.evidence] for one in judged],
            ),
            "",
            "## How",
            "",
            *(f"- {fact}" for fact in facts),
            "",
        ]
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [
        f"| {' | '.join(head)} |",
        f"|{'---|' * len(head)}",
        *(f"| {' | '.join(row)} |" for row in rows),
    ]


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.3g}"
