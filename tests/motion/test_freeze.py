from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.errors import InputError
from motion.freeze import CHANNELS, freeze, moving_channels
from motion.rest_pose import REST_JOINTS
from motion.skeleton import JOINT_NAMES, forward_kinematics, joint_index
from tests.motion.random_clips import assert_same_clip, random_clip

JOINTS = {
    "face": {"jaw", "left_eye", "right_eye"},
    "hands": {name for name in JOINT_NAMES if name[-1] in "123" and "spine" not in name},
    "lower_body": {
        f"{side}_{part}" for side in ("left", "right") for part in ("hip", "knee", "ankle", "foot")
    },
    "root": {"pelvis"},
}


@given(st.sets(st.sampled_from(CHANNELS)), st.integers(0, 99))
def test_only_the_named_channels_become_still(channels: set[str], seed: int) -> None:
    clip = random_clip(seed=seed)
    frozen = freeze(clip, channels)
    still = {name for channel in channels for name in JOINTS[channel]}
    for name in JOINT_NAMES:
        before, after = (one.poses[:, joint_index(name)] for one in (clip, frozen))
        if name in still:
            assert np.ptp(after, axis=0).max() == 0, name
        else:
            np.testing.assert_array_equal(before, after, err_msg=name)
    assert bool(np.any(frozen.trans)) == ("root" not in channels)
    assert bool(np.any(frozen.expressions)) == ("face" not in channels)
    assert bool(np.any(frozen.arkit)) == ("face" not in channels)
    assert_same_clip(freeze(frozen, channels), frozen)


def test_what_differs_in_frozen_channels_alone_becomes_equal() -> None:
    clip, other = random_clip(seed=1), random_clip(seed=2)
    frozen = [freeze(one, CHANNELS) for one in (clip, other)]
    upper = joint_index("left_elbow")
    hand = joint_index("left_index1")
    assert not np.array_equal(frozen[0].poses[:, upper], frozen[1].poses[:, upper])
    np.testing.assert_array_equal(frozen[0].poses[:, hand], frozen[1].poses[:, hand])


@pytest.mark.parametrize("side", ["left", "right"])
def test_frozen_fingers_curl_towards_the_palm(side: str) -> None:
    clip = random_clip()
    still = freeze(clip, ["hands"])
    poses = np.zeros_like(still.poses)
    fingers = [joint_index(name) for name in JOINTS["hands"]]
    poses[:, fingers] = still.poses[:, fingers]
    bent, _ = forward_kinematics(poses, np.zeros((len(clip), 3)), REST_JOINTS)
    tip = joint_index(f"{side}_middle3")
    assert bent[0, tip, 1] < REST_JOINTS[tip, 1] - 0.01
    assert abs(bent[0, tip, 2] - REST_JOINTS[tip, 2]) < 0.01


def test_clip_without_a_face_stays_without() -> None:
    frozen = freeze(random_clip(face=False), ["face"])
    assert frozen.expressions is None
    assert frozen.arkit is None


def test_unknown_channel_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"'legs'.*face, hands, lower_body, root"):
        freeze(random_clip(), ["legs"])


def test_what_a_network_leaves_of_noise_is_no_movement() -> None:
    still = random_clip(frames=1, face=False).frames(np.zeros(5, dtype=int))
    poses = still.poses.copy()
    poses[1, joint_index("jaw")] += 0.005
    assert moving_channels(replace(still, poses=poses)) == frozenset()


def test_a_channel_moves_when_anything_of_it_changes_over_time() -> None:
    still = random_clip(frames=1).frames(np.zeros(5, dtype=int))
    assert moving_channels(still) == frozenset()
    poses = still.poses.copy()
    poses[3, joint_index("left_index2"), 1] += 0.2
    assert moving_channels(replace(still, poses=poses)) == {"hands"}
    trans = still.trans.copy()
    trans[2, 0] += 0.1
    assert moving_channels(replace(still, trans=trans)) == {"root"}
    arkit = np.zeros((5, 52))
    arkit[4, 0] = 0.5
    assert moving_channels(replace(still, arkit=arkit)) == {"face"}


@pytest.mark.parametrize("channel", CHANNELS)
def test_a_frozen_channel_moves_no_more(channel: str) -> None:
    clip = random_clip(frames=4)
    assert channel in moving_channels(clip)
    assert channel not in moving_channels(freeze(clip, [channel]))
