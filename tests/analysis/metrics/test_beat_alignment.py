import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.metrics.beat_alignment import (
    AMUSE,
    BEAT,
    BeatAlignment,
    BeatSettings,
    alignment_score,
    beat_alignment,
    chance_score,
    motion_beats,
)
from motion.arrays import Floats


def test_scores_agree_with_their_closed_form(closed_form: Mapping[str, Any]) -> None:
    expected = closed_form["beat_alignment"]
    near, one_sided = expected["offset_cases"]
    motion, audio = np.array(near["motion"]), np.array(near["audio"])
    assert alignment_score(motion, audio, expected["sigma"]) == pytest.approx(near["score"])
    motion, audio = np.array(one_sided["motion"], float), np.array(one_sided["audio"], float)
    to_audio = alignment_score(motion, audio, expected["sigma"])
    assert to_audio == pytest.approx(one_sided["motion_to_audio"])
    to_motion = alignment_score(audio, motion, expected["sigma"])
    assert to_motion == pytest.approx(one_sided["audio_to_motion"])


def test_the_chance_score_agrees_with_its_closed_form(closed_form: Mapping[str, Any]) -> None:
    for case in closed_form["beat_alignment"]["chance"]:
        period, duration = case["period"], 20.0
        audio = np.arange(period / 2, duration, period)
        motion = np.sort(np.random.default_rng(0).uniform(0, duration, 40))
        chance = chance_score(motion, audio, duration, case["sigma"], "motion to audio")
        assert chance == pytest.approx(case["value"], abs=2e-3)


@pytest.mark.parametrize("frame_rate", [15.0, 30.0, 60.0])
@pytest.mark.parametrize("frequency", [0.5, 1.0])
def test_a_swinging_joint_has_beats_at_its_turning_points(
    frame_rate: float, frequency: float
) -> None:
    time = np.arange(round(6 * frame_rate)) / frame_rate
    position = np.sin(2 * np.pi * frequency * time)
    speed = np.abs(np.diff(position)) * frame_rate
    found = motion_beats(speed, frame_rate)
    turns = np.arange(1 / (4 * frequency), 6, 1 / (2 * frequency))
    inner = turns[(turns > 0.3) & (turns < 5.7)]
    assert np.abs(np.subtract.outer(inner, found)).min(axis=1).max() <= 1 / frame_rate
    assert len(found) <= len(turns)


def test_holds_and_the_deeper_of_close_dips_are_beats_and_noise_is_not() -> None:
    speed = np.concatenate([np.full(20, 0.5), np.zeros(30), np.full(20, 0.5)])
    noise = 1e-4 * np.random.default_rng(0).random(70)
    assert motion_beats(speed, 30.0).tolist() == pytest.approx([(34.5 + 0.5) / 30])
    assert len(motion_beats(speed + noise, 30.0)) == 1
    assert len(motion_beats(noise, 30.0)) == 0
    dips = np.full(40, 1.0)
    dips[18], dips[21] = 0.2, 0.1
    assert motion_beats(dips, 30.0).tolist() == pytest.approx([21.5 / 30])
    falling = np.linspace(2.0, 0.0, 40)
    falling[20] -= 0.2
    assert len(motion_beats(falling, 30.0)) == 0


def aligned(
    positions: Floats, onsets: Floats, settings: BeatSettings, missing: float = 0.0
) -> BeatAlignment:
    """Return the scores of a clip at 30 fps that is `missing` seconds shorter than its speech."""
    return beat_alignment(
        positions,
        onsets,
        speech_duration=len(positions) / 30 + missing,
        frame_rate=30.0,
        settings=settings,
        detector="ears",
    )


def swinging() -> Floats:
    """Return six joints that swing once a second for ten seconds."""
    time = np.arange(300) / 30
    return np.sin(2 * np.pi * time)[:, None, None] * np.ones((1, 6, 3))


@pytest.mark.parametrize("preset", [AMUSE, BEAT], ids=lambda preset: preset.name)
def test_motion_on_the_beat_scores_above_chance_and_off_it_below(preset: BeatSettings) -> None:
    positions = swinging()
    turns = np.arange(0.25, 10, 0.5)

    def above_chance(onsets: Floats) -> float:
        return aligned(positions, onsets, replace(preset, sigma=0.05)).above_chance.value

    assert above_chance(turns) > 0.4
    assert above_chance(turns + 0.25) < -0.1


@pytest.mark.parametrize(
    ("positions", "onsets", "missing", "reason", "rate"),
    [
        (np.zeros((60, 6, 3)), np.array([0.5]), 0, "the motion has no beat", 0),
        (swinging(), np.zeros(0), 0, "the speech has no onset", 2),
        (swinging(), np.array([0.5]), 2, "the clip lasts 10.00 s and its speech 12.00 s", 2),
        (swinging(), np.array([0.5]), -2, "the clip lasts 10.00 s and its speech 8.00 s", 2),
    ],
)
def test_without_beats_or_without_speech_as_long_there_is_a_reason_instead_of_a_score(
    positions: Floats, onsets: Floats, missing: float, reason: str, rate: float
) -> None:
    alignment = aligned(positions, onsets, AMUSE, missing)
    for result in (alignment.score, alignment.chance, alignment.above_chance, alignment.opposite):
        assert math.isnan(result.value)
        assert result.reason == reason
    assert alignment.motion_beats.value == pytest.approx(rate, abs=0.2)


def test_both_directions_are_reported_and_labelled() -> None:
    positions, onsets = swinging(), np.array([0.75, 3.0])
    there, back = (
        aligned(positions, onsets, replace(AMUSE, direction=direction))
        for direction in ("motion to audio", "audio to motion")
    )
    assert there.score.value < back.score.value - 0.1
    assert there.above_chance.value == pytest.approx(there.score.value - there.chance.value)
    assert there.opposite.value == back.score.value
    assert there.score.value == back.opposite.value
    assert there.opposite.settings["direction"] == "audio to motion"
    assert there.score.settings["direction"] == "motion to audio"
    assert there.opposite.n == back.score.n == 2
    assert there.score.n == round(10 * there.motion_beats.value)
    settings = aligned(positions, onsets, BEAT).score.settings
    assert (settings["sigma"], settings["onsets"]) == ("0.3 s", "ears")
    assert "7 frames" in settings["extremum window"]
