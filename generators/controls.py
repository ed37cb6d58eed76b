"""Controls: conditions that a study compares generators with, and an obvious flaw.

`Static` is the lower bound of a comparison: no motion. `Mismatched` is right motion to wrong
speech: the source condition's motion for another segment.

`Broken` is for catch trials, in which AMUSE shows "a broken motion filled with artifacts" (Chhatre
et al. 2024, appendix H) against the recording; whoever does not prefer the recording was not
watching. So the faults must be obvious within two seconds and never stop: limbs pop, joints twist
beyond what a body can do, everything jitters, and the motion sometimes freezes and jumps.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial.transform import Rotation

from generators.interface import ClipRequest, Generator, StudyClips, seeded_stream, with_length
from generators.rule_based.body_pose import Trunk, pose_body
from generators.rule_based.vocabulary import POSES
from motion.arrays import Floats, Floats32
from motion.clip import ARKIT_NAMES, MotionClip
from motion.errors import InputError
from motion.resample import resample
from motion.segment import Segment
from motion.skeleton import joint_index

_COST_OF_MISSING_SECOND: Final = 4.0
_COST_OF_OWN_MOTION: Final = 1e9

_SLOT: Final = 0.8
_POP_SECONDS: Final = (0.1, 0.25)
_TWIST_SECONDS: Final = (0.35, 0.7)
_FREEZE_SECONDS: Final = (0.25, 0.45)
_POPS_IN_SLOT: Final = 2
_POP_DEGREES: Final = (60.0, 110.0)
_TWIST_DEGREES: Final = (120.0, 165.0)
_BACKWARD_DEGREES: Final = (70.0, 110.0)
_JITTER_DEGREES: Final = 5.0
_FINGER_JITTER_DEGREES: Final = 14.0
_ROOT_JITTER: Final = 0.008
_FACE_JITTER: Final = 0.08
_SIDES: Final = ("left", "right")
_POPPING: Final = tuple(f"{side}_{part}" for part in ("shoulder", "elbow") for side in _SIDES)
_TWISTING: Final = ("neck", "left_wrist", "right_wrist")
_BENDING_BACK: Final = MappingProxyType({"left_elbow": 1.0, "right_elbow": -1.0})
_JITTERING: Final = (
    *("spine1", "spine2", "spine3", "neck", "head"),
    *(f"{side}_{part}" for part in ("collar", "shoulder", "elbow", "wrist") for side in _SIDES),
)


class Static(Generator):
    """Stands with the arms down and a neutral face; nothing moves."""

    name = "static"
    version = "1"

    def make_clip(self, request: ClipRequest) -> MotionClip:
        """Return the clip; the seed has no effect."""
        frames = request.frames
        hand = POSES["by_the_side"].channels()[None]
        poses, trans = pose_body(Trunk(), {"left": hand, "right": hand})
        return MotionClip(
            poses=np.repeat(poses, frames, axis=0).astype(np.float32),
            trans=np.repeat(trans, frames, axis=0).astype(np.float32),
            frame_rate=request.frame_rate,
            arkit=np.zeros((frames, len(ARKIT_NAMES)), np.float32),
        )


class Mismatched(Generator):
    """Gives each segment the source condition's clip of another segment."""

    name = "mismatched"
    version = "1"

    def make_clip(self, request: ClipRequest) -> MotionClip:
        """Return the clip of another segment.

        A clip that is too short is extended by running backwards from its last frame, so that
        nothing jumps; this is recorded in the provenance.
        """
        clips, name = _required(request.source, self.name), request.speech.segment.name
        partner, frames = assign_partners(clips.segments, request.seed)[name], request.frames
        clip = resample(clips.clip(partner), request.frame_rate)
        return with_length(clip, frames).with_provenance(
            motion_of_segment=partner, continued_by_reversal=str(frames > len(clip)).lower()
        )


def _required(source: StudyClips | None, generator: str) -> StudyClips:
    if source is None:
        raise InputError(
            f"the generator {generator} changes another condition's motion and was given none",
            remedy="Name that condition as its source in study.toml",
        )
    return source


def assign_partners(segments: Sequence[Segment], seed: int) -> Mapping[str, str]:
    """Return for each segment of a study the segment whose motion it gets.

    No segment keeps its own motion and no two get the same. Among all such assignments, few seconds
    are missing because partners are shorter; ties are broken at random. (The optimal assignment of
    Kuhn 1955, with random costs for ties.)

    Parameters
    ----------
    segments : sequence of Segment
        All segments of the study, in any order.
    seed : int
        Random seed, at least 0.

    Raises
    ------
    InputError
        If there are fewer than two segments.
    """
    if len(segments) < 2:
        raise InputError(
            "mismatched motion needs the motion of another segment, and the study has "
            f"{len(segments)}",
            remedy="Add a second segment, or leave this condition out",
        )
    ordered = sorted(segments, key=lambda segment: segment.name)
    length = np.array([segment.duration for segment in ordered])
    missing = np.maximum(length[:, None] - length[None, :], 0)
    tie_breaks = np.random.default_rng(seeded_stream(seed, Mismatched.name)).random(missing.shape)
    cost = tie_breaks + _COST_OF_MISSING_SECOND * missing
    np.fill_diagonal(cost, _COST_OF_OWN_MOTION)
    takers, givers = linear_sum_assignment(cost)
    return {
        ordered[taker].name: ordered[giver].name
        for taker, giver in zip(takers, givers, strict=True)
    }


class Broken(Generator):
    """Breaks the source condition's clip of the same segment."""

    name = "broken"
    version = "1"

    def make_clip(self, request: ClipRequest) -> MotionClip:
        """Return the broken clip."""
        clips, name = _required(request.source, self.name), request.speech.segment.name
        rng = np.random.default_rng(seeded_stream(request.seed, self.name, name))
        rate, frames = request.frame_rate, request.frames
        source_clip = with_length(resample(clips.clip(name), rate), frames)
        stuttering = source_clip.frames(_stutter(frames, rate, rng))
        broken_face = _break_face(stuttering, rng)
        return replace(
            source_clip,
            poses=_break_body(stuttering, rng),
            trans=stuttering.trans + rng.normal(0, _ROOT_JITTER, (frames, 3)).astype(np.float32),
            arkit=broken_face,
        )


def _slots(frames: int, frame_rate: float) -> NDArray[np.int_]:
    """Return the first frame of each slot, which gets its own faults."""
    return np.arange(0, frames, max(1, round(_SLOT * frame_rate)))


def _span(
    slot: int, seconds: tuple[float, float], frame_rate: float, rng: np.random.Generator
) -> slice:
    """Return a span of frames that starts in the slot's first half."""
    begin = slot + round(rng.uniform(0, _SLOT / 2) * frame_rate)
    return slice(begin, begin + max(1, round(rng.uniform(*seconds) * frame_rate)))


def _stutter(frames: int, frame_rate: float, rng: np.random.Generator) -> NDArray[np.int_]:
    """Return frame indices that freeze for a while in every other slot and then jump."""
    index = np.arange(frames)
    for slot in _slots(frames, frame_rate)[1::2]:
        frozen = _span(slot, _FREEZE_SECONDS, frame_rate, rng)
        index[frozen] = min(frozen.start, frames - 1)
    return index


def _break_body(clip: MotionClip, rng: np.random.Generator) -> Floats32:
    """Return the clip's poses, shape (T, 55, 3), with faults from the first half second on."""
    poses = clip.poses.astype(float)
    rate = clip.frame_rate
    for slot in _slots(len(clip), rate):
        for joint in rng.choice(_POPPING, _POPS_IN_SLOT, replace=False):
            span = _span(slot, _POP_SECONDS, rate, rng)
            _turn(poses[span, joint_index(joint)], _random_turn(_POP_DEGREES, rng))
        joint = rng.choice(_TWISTING)
        span = _span(slot, _TWIST_SECONDS, rate, rng)
        poses[span, joint_index(joint)] = _random_turn(_TWIST_DEGREES, rng)
        elbow = rng.choice(list(_BENDING_BACK))
        backward = _BENDING_BACK[elbow] * np.radians(rng.uniform(*_BACKWARD_DEGREES))
        span = _span(slot, _TWIST_SECONDS, rate, rng)
        poses[span, joint_index(elbow)] = (0.0, backward, 0.0)
    for name in _JITTERING:
        joint = joint_index(name)
        poses[:, joint] += rng.normal(0, np.radians(_JITTER_DEGREES), (len(clip), 3))
    fingers = poses[:, joint_index("left_index1") :]
    fingers += rng.normal(0, np.radians(_FINGER_JITTER_DEGREES), fingers.shape)
    return poses.astype(np.float32)


def _random_turn(degrees: tuple[float, float], rng: np.random.Generator) -> Floats:
    """Return a turn, axis-angle, about a random axis by an angle within `degrees`."""
    axis = rng.normal(size=3)
    turn: Floats = axis / np.linalg.norm(axis) * np.radians(rng.uniform(*degrees))
    return turn


def _turn(rotvecs: Floats, turn: Floats) -> None:
    """Turn `rotvecs`, shape (T, 3), by `turn` in place."""
    if len(rotvecs):
        rotvecs[:] = (Rotation.from_rotvec(turn) * Rotation.from_rotvec(rotvecs)).as_rotvec()


def _break_face(clip: MotionClip, rng: np.random.Generator) -> Floats32 | None:
    """Return the clip's facial actions, flickering and sometimes at full strength."""
    if clip.arkit is None:
        return None
    arkit = clip.arkit + rng.normal(0, _FACE_JITTER, clip.arkit.shape)
    for slot in _slots(len(clip), clip.frame_rate):
        for action in rng.choice(arkit.shape[1], 4, replace=False):
            arkit[_span(slot, _POP_SECONDS, clip.frame_rate, rng), action] = 1.0
    return np.clip(arkit, 0, 1).astype(np.float32)
