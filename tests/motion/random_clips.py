"""Motion clips for tests."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from motion.arrays import Floats, Floats32
from motion.clip import GENDERS, MotionClip
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index

Numbers = NDArray[np.floating]


def clip_of(
    poses: Numbers, trans: Numbers | None = None, frame_rate: float = 30, **more: Numbers | None
) -> MotionClip:
    """Return the clip of `poses`, shape (T, 55, 3); it stays at the origin without `trans`."""
    still = np.zeros((len(poses), 3))
    arrays: dict[str, Any] = {"poses": poses, "trans": still if trans is None else trans, **more}
    return MotionClip(frame_rate=frame_rate, **arrays)


def joint_positions(clip: MotionClip, rest: Numbers = REST_JOINTS) -> Floats:
    return forward_kinematics(clip.poses, clip.trans, rest)[0]


def largest_angle(
    one: MotionClip,
    other: MotionClip,
    bones: Sequence[tuple[str, str]],
    rest: Numbers = REST_JOINTS,
) -> float:
    """Return the largest angle in degrees between the directions of any of `bones` in two clips."""
    starts, ends = ([joint_index(bone[side]) for bone in bones] for side in (0, 1))
    at = [joint_positions(clip, rest) for clip in (one, other)]
    first, second = (each[:, ends] - each[:, starts] for each in at)
    across = np.linalg.norm(np.cross(first, second), axis=2)
    return float(np.degrees(np.arctan2(across, (first * second).sum(axis=2))).max())


def arkit_of(clip: MotionClip) -> Floats32:
    """Return the facial actions of a clip that has them."""
    assert clip.arkit is not None
    return clip.arkit


def random_clip(
    frames: int = 12, frame_rate: float = 30, seed: int = 0, *, face: bool = True
) -> MotionClip:
    """Return a clip whose every value differs from its neighbours'."""
    rng = np.random.default_rng(seed)
    return clip_of(
        rng.uniform(-1, 1, (frames, 55, 3)),
        rng.uniform(-1, 1, (frames, 3)),
        frame_rate,
        betas=rng.uniform(-1, 1, 16),
        expressions=rng.uniform(-1, 1, (frames, 100)) if face else None,
        arkit=rng.uniform(0, 1, (frames, 52)) if face else None,
    ).with_provenance(generator="random", seed=str(seed))


@st.composite
def clips(draw: st.DrawFn) -> MotionClip:
    """Draw any clip a study may hold."""
    clip = random_clip(
        draw(st.integers(1, 20)),
        draw(st.sampled_from([15.0, 25.0, 29.97, 30.0, 60.0, 120.0])),
        draw(st.integers(0, 2**32 - 1)),
        face=draw(st.booleans()),
    )
    gender = draw(st.sampled_from(GENDERS))
    facts = draw(st.dictionaries(st.text(max_size=9), st.text(max_size=9), max_size=3))
    betas = clip.betas[: draw(st.integers(0, 16))]
    return replace(clip, betas=betas, gender=gender, provenance=facts)


def assert_same_clip(left: MotionClip, right: MotionClip) -> None:
    """Fail unless both clips are equal in every field."""
    for name in ("poses", "trans", "betas", "expressions", "arkit"):
        np.testing.assert_array_equal(getattr(left, name), getattr(right, name), err_msg=name)
    for name in ("frame_rate", "gender", "provenance"):
        assert getattr(left, name) == getattr(right, name), name
