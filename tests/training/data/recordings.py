"""Recordings for tests: a joint that jumps at known moments, and a click at each of them."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import soundfile

from motion.clip import ARKIT_NAMES
from motion.formats.beat_tracks import write_arkit_json
from motion.skeleton import JOINT_COUNT, joint_index
from tests.motion.formats.bvh_text import Skeleton, bvh_text, save_bvh_text
from training.data.take import Feature, Take
from training.spaces.beat import BEAT_SKELETON

SKELETON: Skeleton = [
    (joint.name, BEAT_SKELETON[joint.parent].name if joint.parent >= 0 else None, joint.offset)
    for joint in BEAT_SKELETON
]

DOWN = 40.0
"""Degrees by which the right arm jumps down, and in the next frame up again."""


def touch(*paths: Path) -> None:
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"not looked at yet")


def beat_take(folder: Path, name: str, *endings: str) -> None:
    touch(*(folder / f"{name}{ending}" for ending in (".bvh", ".wav", *endings)))


def is_down(moments: Sequence[float], frames: int, frame_rate: float) -> np.ndarray:
    """Return whether the arm is down at ``k / frame_rate`` seconds."""
    times = np.arange(frames) / frame_rate
    down: np.ndarray = np.searchsorted(sorted(moments), times, side="right") % 2 == 1
    return down


def write_clicks(
    path: Path, seconds: float, moments: Sequence[float] = (), rate: int = 16000
) -> Path:
    """Write faint noise with a click of two milliseconds at each moment."""
    path.parent.mkdir(parents=True, exist_ok=True)
    sound = 1e-3 * np.random.default_rng(1).standard_normal(round(seconds * rate))
    for moment in moments:
        first = round(moment * rate)
        sound[first : first + rate // 500] = 0.8
    soundfile.write(path, sound, rate, format="WAV", subtype="PCM_16")
    return path


def write_beat_motion(
    path: Path,
    seconds: float,
    moments: Sequence[float] = (),
    rate: int = 120,
    *,
    promised: int | None = None,
) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    frames = round(seconds * rate)
    rows = np.zeros((frames, 3 + 3 * len(SKELETON)))
    arm = 3 + 3 * [joint.name for joint in BEAT_SKELETON].index("RightArm")
    rows[is_down(moments, frames, rate), arm + 2] = DOWN
    return save_bvh_text(
        path, bvh_text(SKELETON, rows, order="XYZ", frame_time=f"{1 / 120:.6f}", frames=promised)
    )


def write_beat_take(folder: Path, seconds: float, moments: Sequence[float]) -> None:
    """Write a take of BEAT: motion, sound and face."""
    write_beat_motion(folder / "2_scott_0_9_9.bvh", seconds, moments)
    write_clicks(folder / "2_scott_0_9_9.wav", seconds, moments)
    weights = np.zeros((round(seconds * 60), 51))
    weights[is_down(moments, len(weights), 60), ARKIT_NAMES.index("jawOpen")] = 0.5
    write_arkit_json(folder / "2_scott_0_9_9.json", weights, 60)


def write_smplx(
    path: Path, seconds: float, moments: Sequence[float] = (), rate: float = 30
) -> Path:
    """Write motion as BEAT2 holds it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    frames = round(seconds * rate)
    poses = np.zeros((frames, JOINT_COUNT, 3), np.float32)
    poses[is_down(moments, frames, rate), joint_index("right_shoulder"), 2] = np.radians(DOWN)
    np.savez(
        path,
        poses=poses.reshape(frames, -1),
        expressions=np.zeros((frames, 100), np.float32),
        trans=np.zeros((frames, 3), np.float32),
        betas=np.zeros(300, np.float32),
        mocap_frame_rate=rate,
        model="smplx2020",
        gender="neutral",
    )
    return path


def write_show(path: Path, seconds: float, moments: Sequence[float] = ()) -> Path:
    """Write motion as TalkSHOW holds it, at 30 fps."""
    path.parent.mkdir(parents=True, exist_ok=True)
    frames = round(seconds * 30)
    rows = np.zeros((frames, 265), np.float32)
    right_shoulder = 12 + 3 * (joint_index("right_shoulder") - 1)
    rows[is_down(moments, frames, 30), right_shoulder + 2] = np.radians(DOWN)
    np.save(path, rows)
    return path


def write_ted(path: Path, seconds: float, moments: Sequence[float] = ()) -> Path:
    """Write motion of TED Gesture as plain arrays, at 15 fps."""
    path.parent.mkdir(parents=True, exist_ok=True)
    frames = round(seconds * 15)
    directions = np.tile([0.0, 1.0, 0.0], (frames, 9, 1))
    directions[is_down(moments, frames, 15), 7] = [1.0, 0.0, 0.0]
    np.savez(path, directions=directions.reshape(frames, 27).astype(np.float32))
    return path


def counting(
    name: str, compute: Callable[[Take], np.ndarray], version: str = "1"
) -> tuple[Feature, list[str]]:
    """Return a feature, and the names of the takes it was computed of."""
    asked: list[str] = []

    def counted(take: Take) -> np.ndarray:
        asked.append(take.name)
        return compute(take)

    return Feature(name=name, version=version, compute=counted), asked
