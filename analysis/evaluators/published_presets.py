"""The published networks: their inputs and how their authors used them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation
from torch import nn

from analysis.evaluators.feature_networks import PUBLISHED
from analysis.evaluators.published_networks import EmageNetwork, TalkShowNetwork, YoonNetwork
from analysis.metrics.frechet import Rule
from motion.arrays import Floats
from motion.clip import MotionClip
from motion.formats.bvh_motion import BvhMotion
from motion.formats.joint_maps import choose_joint_map
from motion.formats.retarget import rest_corrections
from motion.formats.ted_npz import BONES
from motion.skeleton import FINGERS, RELAXED_HANDS, REST_JOINTS, forward_kinematics, joint_index
from training.spaces.beat import BEAT_SKELETON, UPPER_BODY_JOINTS
from training.spaces.smplx_bodies import rotation_rows

MEAN_DIRECTIONS: Final = np.array(
    [
        0.0154009, -0.9690125, -0.0884354, -0.0022264, -0.8655276, 0.4342174,
        -0.0035145, -0.8755367, -0.4121039, -0.9236511, 0.3061306, -0.0012415,
        -0.5155854, 0.8129665, 0.0871897, 0.2348464, 0.1846561, 0.8091402,
        0.9271948, 0.2960011, -0.013189, 0.5233978, 0.8092403, 0.0725451,
        -0.2037076, 0.1924306, 0.8196916,
    ]
)  # fmt: skip
"""``mean_dir_vec`` of TED Gesture (Yoon et al. 2020), shape (27,)."""

_TO_TED: Final = np.array([-1.0, -1.0, 1.0])
"""TED Gesture's axes: x to the person's right, y down, z forward."""

_HEAD_BONES: Final = (0.18 / 0.36, 0.14 / 0.36)
"""Neck to nose and nose to crown in TED Gesture, in lengths of an upper arm."""

_SHOW_ORDER: Final = (
    *(joint_index(name) for name in ("jaw", "left_eye", "right_eye")),
    *range(joint_index("right_wrist") + 1),
    *range(FINGERS.start, FINGERS.stop),
)
"""SMPL-X joints in the order of SHOW's files."""

_NOT_SHOWN: Final = (0, 1, 2, 3, 4, 5, 7, 8, 10, 11, 15, 16)
"""Places in `_SHOW_ORDER` that TalkSHOW's published code leaves out: jaw, eyes, pelvis, hips, knees
and ankles; also neck and left collar, in place of which it keeps both feet."""

TALKSHOW_JOINTS: Final = tuple(
    joint for place, joint in enumerate(_SHOW_ORDER) if place not in _NOT_SHOWN
)
"""The 43 SMPL-X joints that TalkSHOW's network sees, in its order."""


def talkshow_frames(clip: MotionClip) -> Floats:
    """Return the axis-angles that TalkSHOW's published code picks, (T, 129).

    Its fingers are relative to SMPL-X's mean hands; here they are relative to relaxed hands.
    """
    poses = clip.poses.astype(float)
    poses[:, FINGERS] -= RELAXED_HANDS
    return np.asarray(poses[:, list(TALKSHOW_JOINTS)].reshape(len(clip), -1))


def ted_frames(clip: MotionClip) -> Floats:
    """Return the directions of nine bones of the upper body less their mean, (T, 27)."""
    joints = ted_joints(clip)
    parents, children = np.array(BONES).T
    bones = joints[:, children] - joints[:, parents]
    directions = bones / np.linalg.norm(bones, axis=2, keepdims=True)
    return np.asarray(directions.reshape(len(clip), -1) - MEAN_DIRECTIONS)


def ted_joints(clip: MotionClip) -> Floats:
    """Return TED Gesture's ten joints on the body, shape (T, 10, 3), in its axes and in metres.

    Spine, neck, nose, crown, then shoulder, elbow and wrist of the left and of the right. SMPL-X
    has no joint for nose and crown; on an unturned head they are placed as in the data set's mean
    pose.
    """
    positions, turns = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    head = joint_index("head")
    arm = REST_JOINTS[joint_index("left_shoulder")] - REST_JOINTS[joint_index("left_elbow")]
    bones = np.outer(_HEAD_BONES, np.ones(3)) * np.linalg.norm(arm)
    of_neck = np.cumsum(bones * MEAN_DIRECTIONS.reshape(-1, 3)[1:3] * _TO_TED, axis=0)
    at_rest = REST_JOINTS[joint_index("neck")] + of_neck - REST_JOINTS[head]
    nose, crown = (positions[:, head] + turns[:, head] @ offset for offset in at_rest)
    limbs = [
        positions[:, joint_index(f"{side}_{part}")]
        for side in ("left", "right")
        for part in ("shoulder", "elbow", "wrist")
    ]
    trunk = [positions[:, joint_index(name)] for name in ("spine2", "neck")]
    return np.asarray(np.stack([*trunk, nose, crown, *limbs], axis=1) * _TO_TED)


def beat_frames(clip: MotionClip) -> Floats:
    """Return local Euler angles of BEAT's 47 joints, about x, y, z, in degrees, (T, 141).

    This reverses the retargeting of BEAT's recordings to our body: spine and neck bend in their
    lowest joints. The roots of three fingers, for which SMPL-X has no joint, are NaN.
    """
    world = _beat_world(clip)
    parents = {joint.name: joint.parent for joint in BEAT_SKELETON}
    names = [joint.name for joint in BEAT_SKELETON]
    angles = np.full((len(clip), len(UPPER_BODY_JOINTS), 3), np.nan)
    for place, name in enumerate(UPPER_BODY_JOINTS):
        if name not in world:
            continue
        above = names[parents[name]]
        while above not in world:
            above = names[parents[above]]
        local = world[above].inv() * world[name]
        # If several angles mean the same rotation, any will do.
        angles[:, place] = local.as_euler("XYZ", degrees=True, suppress_warnings=True)
    return angles.reshape(len(clip), -1)


def _beat_world(clip: MotionClip) -> dict[str, Rotation]:
    """Return the world rotation of each joint of BEAT's skeleton that SMPL-X determines."""
    rest = BvhMotion(joints=BEAT_SKELETON, values=np.zeros((1, 0)), frame_rate=clip.frame_rate)
    _, joint_map = choose_joint_map(rest.joint_names)
    places = rest.rest_positions
    corrections = rest_corrections(
        {joint: places[rest.joint_names.index(name)] for joint, name in joint_map.items()},
        {joint: REST_JOINTS[joint_index(joint)] for joint in joint_map},
    )
    _, turns = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    world = {
        name: Rotation.from_matrix(turns[:, joint_index(joint)]) * corrections[joint].inv()
        for joint, name in joint_map.items()
    }
    # BEAT's joints between these do not turn: the lowest one does their part.
    world["Spine"] = world["Spine3"]
    world["Neck1"] = world["Head"]
    return world


@dataclass(frozen=True, kw_only=True)
class Preset:
    """One published network, and how its authors used it.

    Attributes
    ----------
    title : str
        Its name in scores.
    source : str
        The code it follows: repository, commit and class.
    sees : str
        The channels of a frame in words.
    frames : callable
        Turns a clip at `frame_rate` into frames, shape (T, channels).
    channels, features : int
        Length of a frame, and of a row of features.
    frame_rate : float
        Frames per second.
    window, span, stride : int
        Frames of a window, frames that must remain at a window's start, and frames from one window
        to the next; a window of 0 is the whole clip.
    shortest : int
        Fewest frames that the network accepts, if the whole clip is a window.
    cut : str
        The cutting of windows in words.
    rule : {'pytorch-fid', 'offset'}
        How the published code computes the Fréchet distance.
    network : callable
        Makes the network, without its weights.
    place : tuple of str
        Keys of the checkpoint under which the weights are.
    """

    title: str
    source: str
    sees: str
    frames: Callable[[MotionClip], Floats]
    channels: int
    features: int
    frame_rate: float
    window: int = 0
    span: int = 0
    stride: int = 10
    shortest: int = 0
    cut: str
    rule: Rule
    network: Callable[[], nn.Module]
    place: tuple[str, ...]


PRESETS: Final[Mapping[str, Preset]] = MappingProxyType(
    {
        "emage": Preset(
            title=PUBLISHED["emage"],
            source="PantoMatrix 0bbb03d, VAESKConv (AESKConv_240_100.bin)",
            sees="55 SMPL-X joints, the first two rows of each rotation matrix, not normalised",
            frames=rotation_rows,
            channels=330,
            features=240,
            frame_rate=30.0,
            shortest=32,
            cut="the whole clip, without its last frames past a multiple of 32; a row of features "
            "for every 16 frames",
            rule="offset",
            network=EmageNetwork,
            place=("model_state",),
        ),
        "beat": Preset(
            title=PUBLISHED["beat"],
            source="beat2022dataset b6e5d80, HalfEmbeddingNet (ae_300.bin)",
            sees="47 joints of BEAT, XYZ Euler angles in degrees, in deviations of BEAT's frames",
            frames=beat_frames,
            channels=141,
            features=300,
            frame_rate=15.0,
            window=34,
            span=34,
            cut="34 frames, every 10 frames: neighbours overlap",
            rule="pytorch-fid",
            network=partial(YoonNetwork, 141, (300, 600, 600, 300), (1200, 600, 300)),
            place=("model_state",),
        ),
        "ted": Preset(
            title=PUBLISHED["ted"],
            source="ai4r f81004c, EmbeddingNet, mode pose",
            sees="directions of 9 bones of the upper body, less TED Gesture's mean",
            frames=ted_frames,
            channels=27,
            features=32,
            frame_rate=15.0,
            window=34,
            span=42,
            cut="the first 34 of 42 frames, every 10 frames: neighbours overlap; no window is "
            "filtered out",
            rule="pytorch-fid",
            network=partial(YoonNetwork, 27, (32, 64, 64, 32), (256, 128, 32)),
            place=("gen_dict",),
        ),
        "talkshow": Preset(
            title=PUBLISHED["talkshow"],
            source="TalkSHOW 9aef82d, body autoencoder (feature_extractor.pth)",
            sees="43 SMPL-X joints, axis-angle, fingers against the mean hands, not normalised",
            frames=talkshow_frames,
            channels=129,
            features=64,
            frame_rate=30.0,
            shortest=4,
            cut="the whole clip; a row of features for every 4 frames",
            rule="pytorch-fid",
            network=TalkShowNetwork,
            place=("generator", "g"),
        ),
    }
)
"""Presets by name."""
