"""The control generators: static, mismatched and broken."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.controls import Broken, Mismatched, Static, assign_partners
from generators.interface import StudyClips
from motion.clip import MotionClip
from motion.errors import InputError
from motion.segment import Segment
from motion.skeleton import joint_index
from tests.generators.conftest import ClipsInMemory, spoken
from tests.motion.random_clips import arkit_of, joint_positions

ARM = [joint_index(f"{side}_{part}") for side in ("left", "right") for part in ("elbow", "wrist")]


def test_a_still_body_has_both_hands_hanging_beside_it() -> None:
    clip = Static().generate(spoken("a", 3.0), seed=0, frame_rate=30)
    assert (clip.poses == clip.poses[0]).all()
    assert not arkit_of(clip).any()
    left, pelvis = joint_positions(clip)[0, [joint_index("left_wrist"), joint_index("pelvis")]]
    assert left[1] < pelvis[1]
    assert 0.17 < left[0] < 0.4


def of_length(*seconds: float) -> list[Segment]:
    return [
        Segment(name=f"s{k}", wav="a.wav", start=0, end=end, speaker="a", emotion="neutral")
        for k, end in enumerate(seconds)
    ]


@given(st.lists(st.floats(0.5, 60), min_size=2, max_size=12), st.integers(0, 2**32))
def test_mismatching_is_a_derangement(lengths: list[float], seed: int) -> None:
    segments = of_length(*lengths)
    chosen = assign_partners(segments, seed)
    assert chosen == assign_partners(segments[::-1], seed)
    assert all(taker != giver for taker, giver in chosen.items())
    assert sorted(chosen.values()) == sorted(chosen)


def test_partners_long_enough_are_preferred() -> None:
    for seed in range(20):
        chosen = assign_partners(of_length(10, 10, 4, 4), seed)
        assert {chosen["s0"], chosen["s1"]} == {"s0", "s1"}


def test_a_partners_short_motion_continues_backwards_without_a_jump(study: StudyClips) -> None:
    speech = spoken(study.segments[2].name, 15.0)
    clip = Mismatched().generate(speech, seed=3, frame_rate=25, source=study)
    assert clip.provenance["motion_of_segment"] != speech.segment.name
    own = study.clip(clip.provenance["motion_of_segment"])
    np.testing.assert_array_equal(clip.poses[: len(own)], own.poses)
    assert clip.provenance["continued_by_reversal"] == "true"
    np.testing.assert_array_equal(clip.poses[len(own)], own.poses[-2])


def test_a_segment_without_a_partner_is_refused() -> None:
    with pytest.raises(InputError, match="another segment"):
        assign_partners(of_length(5), 0)


def jerk(clip: MotionClip) -> np.ndarray:
    """Size of the third derivative of elbows and wrists, m/s^3, shape (T - 3, 4)."""
    third = np.diff(joint_positions(clip)[:, ARM], n=3, axis=0) * clip.frame_rate**3
    return np.asarray(np.linalg.norm(third, axis=2))


@pytest.mark.parametrize("seed", range(2))
def test_faults_show_within_every_two_seconds(seed: int, study: StudyClips) -> None:
    whole = study.clip(study.segments[2].name)
    speech = spoken(study.segments[2].name, len(whole) / 25)
    broken = Broken().generate(speech, seed=seed, frame_rate=25, source=study)
    turns = np.degrees(np.linalg.norm(broken.poses, axis=2))
    twisting = [joint_index(name) for name in ("neck", "left_wrist", "right_wrist")]
    twisted = (turns[:, twisting] > 110).any(axis=1)
    # Elbows bend about -y on the left and +y on the right.
    backward = np.degrees(
        broken.poses[:, [joint_index("left_elbow"), joint_index("right_elbow")], 1]
    )
    bent_back = np.max(backward * (1, -1), axis=1) > 50
    for start in range(0, len(broken) - 50, 25):
        part = slice(start, start + 50)
        assert twisted[part].any()
        assert bent_back[part].any()
        assert jerk(broken)[part].mean() > 8 * jerk(whole)[part].mean()
    smooth, flickering = (
        np.abs(np.diff(arkit_of(clip), axis=0)).mean() for clip in (whole, broken)
    )
    assert flickering > 5 * smooth


def test_a_source_without_a_face_gets_none(study: ClipsInMemory) -> None:
    faceless = replace(
        study, clips={name: replace(clip, arkit=None) for name, clip in study.clips.items()}
    )
    speech = spoken(study.segments[0].name, 4.0)
    assert Broken().generate(speech, seed=0, frame_rate=25, source=faceless).arkit is None
