"""Acceleration where one window of generated motion joins the next, relative to elsewhere.

Motion that is generated window by window, as by DiffSHEG's outpainting (Chen et al. 2024, section
3.5), may jerk at the borders. A clip's provenance records where those are.
"""

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.kinematics import UPPER_BODY_JOINTS, WRISTS, joint_motion, select
from analysis.metrics.scores import Metric, MetricResult
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.resample import resample
from motion.skeleton import LEFT_HAND_JOINTS, RIGHT_HAND_JOINTS

FloatArray = NDArray[np.float64]

_RESAMPLES: Final = 2000
_SEED: Final = 1


@dataclass(frozen=True, kw_only=True)
class Windows:
    """The windows of a motion.

    Attributes
    ----------
    frames : int
        Frames of a window.
    overlap : int
        Frames that a window shares with the previous one.
    frame_rate : float
        Frames per second of both counts.
    """

    frames: int
    overlap: int
    frame_rate: float

    @property
    def step(self) -> int:
        """Frames from the start of one window to the start of the next."""
        return self.frames - self.overlap


def windows_of(clip: MotionClip) -> Windows:
    """Return the windows of the motion of `clip`, from its provenance.

    Raises
    ------
    InputError
        If its provenance does not record them.
    """
    facts = clip.provenance
    try:
        return Windows(
            frames=int(facts["window_frames"]),
            overlap=int(facts["window_overlap"]),
            frame_rate=float(facts["window_frame_rate"]),
        )
    except (KeyError, ValueError) as error:
        raise InputError(
            "the clip does not say where its windows of motion begin",
            remedy="Give a clip that 'motionjury generate' made with a network that goes window "
            "by window",
        ) from error


def seam_acceleration(values: FloatArray, windows: Windows, *, of: str) -> MetricResult:
    """Return the ratio of accelerations at the seams of windows to those elsewhere.

    Parameters
    ----------
    values : ndarray, shape (T, N, D)
        N points of D coordinates in any unit, at the windows' frame rate.
    windows : Windows
        The windows of the motion.
    of : str
        Description of the points, for the result's name.

    Returns
    -------
    MetricResult
        Mean norm of the second differences that involve a window's shared frames or the step into
        or out of them, over the mean norm of all others; 1 if seams are invisible. Its interval is
        a bootstrap over windows. NaN with fewer than two seams or no motion elsewhere.
    """
    sizes = np.linalg.norm(np.diff(values, n=2, axis=0), axis=2).mean(axis=1)
    # Difference k is centred on frame k + 1.
    centres = np.arange(len(sizes)) + 1
    within = (centres + 1) % windows.step
    at_seam = (centres >= windows.step - 1) & (within <= windows.overlap + 1)
    window = np.maximum((centres + 1) // windows.step - 1, 0)
    counted = np.stack([at_seam, at_seam * sizes, ~at_seam, ~at_seam * sizes])
    sums = np.stack([np.bincount(window, weights=row) for row in counted])
    seams = int(np.count_nonzero(sums[0]))
    metric = Metric(f"acceleration at seams over elsewhere ({of})", better="near the reference")
    settings = {
        "windows": f"{windows.frames} frames at {windows.frame_rate:g} fps, "
        f"{windows.overlap} shared",
        "interval": f"bootstrap over windows, {_RESAMPLES} samples",
    }
    if seams < 2:
        return metric.missing(f"the clip has {seams} seams, and two are needed", settings)
    if not sums[3].sum():
        return metric.missing("nothing moves between the seams", settings)
    chance = np.random.default_rng(_SEED)
    drawn = chance.integers(0, sums.shape[1], (_RESAMPLES, sums.shape[1]))
    low, high = np.quantile(_ratio(sums[:, drawn].sum(axis=2)), (0.025, 0.975))
    value = float(_ratio(sums.sum(axis=1)))
    return metric.score(value, seams, settings, interval=(float(low), float(high)))


def seams_of_clip(clip: MotionClip) -> Iterator[MetricResult]:
    """Yield `seam_acceleration` of arms and head, of fingers, and of the face if there is one.

    Raises
    ------
    InputError
        If the clip's provenance does not record its windows.
    """
    windows = windows_of(clip)
    positions = joint_motion(clip, windows.frame_rate).relative
    yield seam_acceleration(select(positions, UPPER_BODY_JOINTS), windows, of="arms and head")
    fingers = []
    for wrist, joints in zip(WRISTS, (LEFT_HAND_JOINTS, RIGHT_HAND_JOINTS), strict=True):
        fingers.append(select(positions, joints) - select(positions, (wrist,)))
    yield seam_acceleration(np.concatenate(fingers, axis=1), windows, of="fingers")
    slow = resample(clip, windows.frame_rate)
    face = slow.expressions if slow.arkit is None else slow.arkit
    if face is not None:
        yield seam_acceleration(face.astype(np.float64)[:, :, None], windows, of="face")


def _ratio(sums: FloatArray) -> FloatArray:
    """Return the mean at seams over the mean elsewhere, from rows of counts and sums (4, ...)."""
    at_seams, size_there, elsewhere, size_elsewhere = sums
    mean_at_seams = size_there / np.maximum(at_seams, 1)
    return np.asarray(mean_at_seams * elsewhere / np.maximum(size_elsewhere, 1e-300))


def main() -> None:
    """Print the seams of the clips named on the command line."""
    for path in map(Path, sys.argv[1:]):
        for seam in seams_of_clip(read_clip(path)):
            low, high = seam.interval or (math.nan, math.nan)
            print(f"{path}: {seam.name}: {seam.value:.2f} ({low:.2f} to {high:.2f})")


if __name__ == "__main__":
    main()
