from __future__ import annotations

import math
from dataclasses import replace

import pytest

from analysis.evaluators import feature_networks as names
from analysis.metrics.scores import ConditionScore, EmotionConfusion, StudyMetrics
from benchmarks.learned_motion.compared_study import RULE_BASED, UNTRAINED
from benchmarks.learned_motion.comparison import Followings, edit_verdicts, verdicts
from benchmarks.learned_motion.editing import BY_NAME, Edited
from benchmarks.learned_motion.following import MEASURES, MeanFollowed
from benchmarks.learned_motion.page import HEARD, Findings, page
from studyapp.study.settings.study import GROUND_TRUTH

NOTHING = MeanFollowed(mean=math.nan, low=math.nan, high=math.nan, clips=0)
GOOD = {RULE_BASED: 8.0, UNTRAINED: 10.0, "trained_1": 3.0, "trained_2": 4.0}


def around(mean: float) -> MeanFollowed:
    return MeanFollowed(mean=mean, low=mean - 0.05, high=mean + 0.05, clips=10)


def following(own: float, swapped: float) -> Followings:
    return Followings(
        own=dict.fromkeys(MEASURES, around(own)), swapped=dict.fromkeys(MEASURES, around(swapped))
    )


def judged(
    distances: dict[str, float] | None = None, own: float = 0.3, swapped: float = 0.01
) -> dict[str, bool]:
    followings_of = {name: following(own, swapped) for name in ("trained_1", "trained_2")}
    followings_of[GROUND_TRUTH] = following(0.7, 0.03)
    made = verdicts(GOOD | (distances or {}), followings_of, ("trained_1", "trained_2"))
    return {verdict.claim: verdict.holds for verdict in made}


@pytest.mark.parametrize(
    ("distances", "failed"),
    [
        ({}, ()),
        ({"trained_2": 6.0}, ("at most half",)),
        ({"trained_1": 9.0, "untrained": 30.0}, ("below that of `rule_based`",)),
        ({"trained_1": math.nan}, ("at most half", "below that of `rule_based`")),
    ],
)
def test_one_failing_seed_fails_the_claim(
    distances: dict[str, float], failed: tuple[str, ...]
) -> None:
    claims = judged(distances)
    assert len(claims) == 9
    fallen = [claim for claim, holds in claims.items() if not holds]
    assert len(fallen) == len(failed)
    assert all(words in claim for words, claim in zip(failed, fallen, strict=True))


def score(condition: str, name: str, value: float) -> ConditionScore:
    return ConditionScore(
        condition=condition,
        name=name,
        unit="",
        value=value,
        spread=math.nan,
        scored=1,
        clips=1,
        settings={},
        reason="" if math.isfinite(value) else "none",
    )


METRICS = StudyMetrics(
    frame_rate=15.0,
    clips=(),
    conditions=(score("trained_1", names.FGD, 3.25), score(UNTRAINED, names.FGD, 10.0)),
)


CONFUSION = EmotionConfusion(
    condition="edited",
    network="a" * 64,
    spoken=("anger", "fear"),
    named=("anger", "fear"),
    counts=((3, 1), (2, 4)),
)
EDITED = Edited(
    confusion=CONFUSION,
    speaker_before=0.9,
    speaker_after=0.85,
    speed=0.6,
    strokes_before=around(0.1),
    strokes_after=NOTHING,
)


@pytest.mark.parametrize(
    ("worse", "failed"),
    [
        (replace(EDITED, confusion=replace(CONFUSION, counts=((1, 3), (2, 4)))), 0),
        (replace(EDITED, speaker_after=0.8), 1),
        (replace(EDITED, speed=0.4), 2),
    ],
)
def test_one_seed_with_failing_edits_fails_the_claim(worse: Edited, failed: int) -> None:
    judged = edit_verdicts(BY_NAME, [EDITED, worse])
    assert [number for number, verdict in enumerate(judged) if not verdict.holds] == [failed]


def test_the_page_marks_missing_numbers_and_failed_claims() -> None:
    followings_of = {
        GROUND_TRUTH: following(0.7, 0.0),
        UNTRAINED: following(0.0, 0.0),
        "trained_1": following(0.3, 0.2),
    }
    distances = {"trained_1": 3.25, UNTRAINED: 10.0, RULE_BASED: 8.0}
    judged = {"diffsheg": verdicts(distances, followings_of, ("trained_1",))}
    text = page(
        Findings(
            metrics=METRICS,
            followed=followings_of,
            judged=judged,
            heard={"amuse_1": dict.fromkeys(HEARD, 0.5)},
            edited={BY_NAME: {"amuse_1": EDITED, "amuse_2": EDITED}},
        ),
        ["Made of nothing."],
    )
    assert "| untrained | 10 | – | – |" in text
    assert "| amuse_1 | 0.7 | 0.9 | 0.85 | 0.6 | 0.100 [0.050, 0.150] | – |" in text
    assert "| fear | 4 | 8 |" in text
    assert "| trained_1 | 3.25 |" in text
    assert text.count("**no**") == 4
    assert "- Made of nothing." in text
