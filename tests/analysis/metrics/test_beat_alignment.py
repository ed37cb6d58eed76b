from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from analysis.metrics import beat_alignment as module
from analysis.metrics.beat_alignment import (
    AMUSE,
    BEAT,
    PRESETS,
    TALKSHOW,
    BeatAlignment,
    BeatSettings,
    alignment_score,
    beat_alignment,
    chance_score,
    extremum_order,
    motion_beats,
)

FloatArray = NDArray[np.float64]


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


def test_chance_agrees_with_its_closed_form(closed_form: Mapping[str, Any]) -> None:
    for case in closed_form["beat_alignment"]["chance"]:
        period, duration = case["period"], 20.0
        audio = np.arange(period / 2, duration, period)
        motion = np.sort(np.random.default_rng(0).uniform(0, duration, 40))
        chance = chance_score(motion, audio, duration, case["sigma"], "motion to audio")
        assert chance == pytest.approx(case["value"], abs=2e-3)


def test_beats_a_tenth_of_a_second_late_score_as_the_gaussian_says() -> None:
    beats = np.array([1.0, 2.0, 3.0])
    assert alignment_score(beats, beats, 0.1) == 1.0
    assert alignment_score(beats + 0.1, beats, 0.1) == pytest.approx(math.exp(-0.5))


@pytest.mark.parametrize("empty", [(np.zeros(0), np.ones(1)), (np.ones(1), np.zeros(0))])
def test_no_beats_are_no_score(empty: tuple[FloatArray, FloatArray]) -> None:
    assert math.isnan(alignment_score(*empty, 0.1))


@pytest.mark.parametrize("frame_rate", [15.0, 30.0, 60.0])
@pytest.mark.parametrize("frequency", [0.5, 1.0])
def test_a_swinging_joint_beats_where_it_turns(frame_rate: float, frequency: float) -> None:
    time = np.arange(round(6 * frame_rate)) / frame_rate
    position = np.sin(2 * np.pi * frequency * time)
    speed = np.abs(np.diff(position)) * frame_rate
    found = motion_beats(speed, frame_rate, 7 / 30)
    turns = np.arange(1 / (4 * frequency), 6, 1 / (2 * frequency))
    inner = turns[(turns > 0.3) & (turns < 5.7)]
    assert np.abs(np.subtract.outer(inner, found)).min(axis=1).max() <= 1 / frame_rate
    assert len(found) <= len(turns)


def test_a_hold_is_one_beat_and_noise_far_below_the_motion_none() -> None:
    speed = np.concatenate([np.full(20, 0.5), np.zeros(30), np.full(20, 0.5)])
    noise = 1e-4 * np.random.default_rng(0).random(70)
    assert motion_beats(speed, 30.0, 7 / 30).tolist() == pytest.approx([(34.5 + 0.5) / 30])
    assert len(motion_beats(speed + noise, 30.0, 7 / 30)) == 1
    assert len(motion_beats(noise, 30.0, 7 / 30)) == 0


def test_of_two_close_dips_only_the_deeper_is_a_beat() -> None:
    speed = np.full(40, 1.0)
    speed[18], speed[21] = 0.2, 0.1
    assert motion_beats(speed, 30.0, 7 / 30).tolist() == pytest.approx([21.5 / 30])


def test_the_window_is_the_same_time_at_any_rate_and_never_empty() -> None:
    assert extremum_order(7 / 30, 30) == 7
    assert extremum_order(7 / 30, 60) == 14
    assert extremum_order(0.01, 15) == 1


def aligned(
    positions: FloatArray, onsets: FloatArray, settings: BeatSettings, detector: str = "given"
) -> BeatAlignment:
    """Return the scores of a clip at 30 frames per second."""
    return beat_alignment(positions, onsets, frame_rate=30.0, settings=settings, detector=detector)


def swinging(
    joints: Sequence[str],
    *,
    frame_rate: float = 30.0,
    seconds: float = 10.0,
    frequency: float = 1.0,
) -> FloatArray:
    time = np.arange(round(seconds * frame_rate)) / frame_rate
    return np.repeat(np.sin(2 * np.pi * frequency * time)[:, None, None], 3, axis=2) * np.ones(
        (1, len(joints), 1)
    )


@pytest.mark.parametrize("preset", PRESETS, ids=lambda preset: preset.name)
def test_motion_on_the_beat_scores_above_chance_and_off_the_beat_below(
    preset: BeatSettings,
) -> None:
    positions = swinging(preset.joints)
    turns = np.arange(0.25, 10, 0.5)

    def above_chance(onsets: FloatArray, sigma: float = 0.05) -> float:
        found = aligned(positions, onsets, replace(preset, sigma=sigma))
        return found.above_chance.value

    assert above_chance(turns) > 0.4
    assert above_chance(turns + 0.25) < -0.1


def test_a_wide_gaussian_flatters_unrelated_onsets_and_the_difference_shows_it() -> None:
    onsets = np.sort(np.random.default_rng(4).uniform(0, 10, 25))
    found = aligned(swinging(BEAT.joints), onsets, BEAT)
    assert found.score.value > 0.7
    assert abs(found.above_chance.value) < 0.05
    assert found.above_chance.value == pytest.approx(found.score.value - found.chance.value)


@pytest.mark.parametrize("settings", [AMUSE, TALKSHOW], ids=lambda settings: settings.name)
def test_a_motionless_clip_is_no_score_with_the_reason(settings: BeatSettings) -> None:
    found = aligned(np.zeros((60, 6, 3)), np.array([0.5]), settings)
    assert math.isnan(found.score.value)
    assert found.score.reason == "the motion has no beat"
    assert found.motion_beats.value == 0


def test_speech_without_onsets_is_no_score_with_the_reason() -> None:
    found = aligned(swinging(AMUSE.joints), np.zeros(0), AMUSE)
    assert math.isnan(found.above_chance.value)
    assert found.chance.reason == "the speech has no onset"
    assert found.motion_beats.value == pytest.approx(2.0, abs=0.2)


def test_every_score_says_how_it_was_made() -> None:
    found = aligned(swinging(BEAT.joints), np.array([1.0]), BEAT, detector="ears")
    settings = found.score.settings
    assert settings["direction"] == "audio to motion"
    assert settings["sigma"] == "0.3 s"
    assert settings["frame rate"] == "30 fps"
    assert settings["onsets"] == "ears"
    assert "7 frames" in settings["extremum window"]
    with pytest.raises(TypeError):
        settings["sigma"] = "1 s"  # type: ignore[index]  # a read-only mapping


times = st.lists(st.floats(0, 10), min_size=1, max_size=20).map(np.array)


@given(times, times, st.floats(0.05, 0.5))
def test_scores_lie_between_zero_and_one(
    queries: FloatArray, targets: FloatArray, sigma: float
) -> None:
    assert 0 <= alignment_score(queries, targets, sigma) <= 1
    assert 0 <= chance_score(queries, targets, 10.0, sigma, "audio to motion") <= 1


def test_a_score_counts_what_it_is_a_mean_over() -> None:
    time = np.arange(0, 10, 1 / 30)
    swing = np.sin(2 * np.pi * 0.5 * time)[:, None, None] * np.array([0.1, 0, 0])
    positions = np.repeat(swing, 6, axis=1)
    onsets = np.array([1.0, 4.0, 7.0])
    found = {preset.name: aligned(positions, onsets, preset) for preset in (AMUSE, BEAT)}
    assert found["amuse"].score.n == round(found["amuse"].motion_beats.value * 10)
    assert found["beat"].score.n == 3 * 6


def test_the_direction_decides_whose_missing_partner_counts() -> None:
    positions, onsets = swinging(AMUSE.joints), np.arange(0.0, 10.0, 0.1)
    found = aligned(positions, onsets, AMUSE)
    turned = replace(AMUSE, direction="audio to motion")
    other = aligned(positions, onsets, turned)
    assert found.score.value > 0.85
    assert other.score.value < found.score.value - 0.1


def test_both_directions_are_there_and_say_which_is_which() -> None:
    positions, onsets = swinging(AMUSE.joints), np.array([0.75, 3.0])
    found = {
        preset.direction: aligned(positions, onsets, preset)
        for preset in (AMUSE, replace(AMUSE, direction="audio to motion"))
    }
    there, back = found["motion to audio"], found["audio to motion"]
    assert there.opposite.value == back.score.value
    assert there.score.value == back.opposite.value
    assert there.opposite.settings["direction"] == "audio to motion"
    assert there.opposite.n == back.score.n == 2
    assert there.score.settings["direction"] == "motion to audio"


def test_chance_of_a_long_clip_is_that_of_its_blocks_together(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chance = np.random.default_rng(0)
    motion, audio = chance.uniform(0, 30, 40), chance.uniform(0, 30, 50)
    for direction in ("motion to audio", "audio to motion"):
        at_once = chance_score(motion, audio, 30.0, 0.1, direction)
        with monkeypatch.context() as patch:
            patch.setattr(module, "_DISTANCES_AT_A_TIME", 3 * 40 * 50 + 1)
            assert chance_score(motion, audio, 30.0, 0.1, direction) == pytest.approx(at_once)


def test_bones_that_turn_to_and_fro_beat_where_they_turn_back() -> None:
    time = np.arange(300) / 30
    angle = 0.5 * np.sin(2 * np.pi * 0.5 * time)
    swing = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    positions = np.zeros((300, 6, 3))
    for side, shift in ((0, 1.0), (3, -1.0)):
        positions[:, side + 2, 0] = shift
        positions[:, side + 1] = positions[:, side + 2] + 0.3 * swing
        positions[:, side] = positions[:, side + 1] + 0.25 * swing
    turns = np.arange(0.5, 10, 1.0)
    found = aligned(positions, turns, TALKSHOW)
    assert found.score.value > 0.9
    assert found.motion_beats.value == pytest.approx(1.0, abs=0.1)
    assert found.score.settings["motion"] == "turning of bones, rad/s"
    larger = aligned(3 * positions + 1, turns, TALKSHOW)
    assert larger.score.value == pytest.approx(found.score.value)
