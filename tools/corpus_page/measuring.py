"""Measurements of a corpus' files: its size, how motion follows speech, how fast hands move."""

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from operator import attrgetter
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.arrays import Floats
from motion.audio import read_audio
from motion.errors import InputError
from motion.formats.beat_tracks import read_arkit_json
from motion.formats.bvh import read_bvh
from training.corpus.making import files_of
from training.corpus.plan import DESCRIPTION, CorpusRequest, PlannedTake, planned_takes
from training.corpus.process import VERSION
from training.corpus.speech_curves import SpeechCurves, analyse
from training.corpus.truth import (
    MotionCurves,
    curves_of,
    wrist_positions,
)
from training.data.take import Split
from training.spaces.beat import body_values, face_values

FloatArray = NDArray[np.float64]

FRAME_RATE: Final = 15.0
"""Frames per second of the measurements, the rate of motion in BEAT's networks."""


@dataclass(frozen=True, kw_only=True)
class Pace:
    """One quantity of the wrists, over all frames and both wrists.

    Attributes
    ----------
    quantity : str
        Name and unit.
    mean, median, high : float
        Mean, median and 95th percentile.
    """

    quantity: str
    mean: float
    median: float
    high: float


BEAT: Final = (
    Pace(quantity="speed, m/s", mean=0.53, median=0.41, high=1.4),
    Pace(quantity="acceleration, m/s²", mean=3.6, median=3.0, high=8.7),
)
"""The same for a minute of BEAT's speaker 2 (take 2_scott_0_1_1), on the same figure."""


def paces(wrists: Iterable[FloatArray]) -> tuple[Pace, Pace]:
    """Return speed and acceleration of wrists.

    Parameters
    ----------
    wrists : iterable of ndarray, shape (T, 2, 3)
        Positions in metres in takes of at least two frames, at `FRAME_RATE`.
    """
    speeds, accelerations = [], []
    for positions in wrists:
        velocity = np.gradient(positions, axis=0) * FRAME_RATE
        speeds.append(np.linalg.norm(velocity, axis=2).ravel())
        change = np.gradient(velocity, axis=0) * FRAME_RATE
        accelerations.append(np.linalg.norm(change, axis=2).ravel())
    return _pace("speed, m/s", speeds), _pace("acceleration, m/s²", accelerations)


def _pace(quantity: str, values: list[FloatArray]) -> Pace:
    joined = np.concatenate(values)
    return Pace(
        quantity=quantity,
        mean=float(joined.mean()),
        median=float(np.median(joined)),
        high=float(np.percentile(joined, 95)),
    )


CURVES: Final = tuple(field.name for field in fields(MotionCurves))


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredTake:
    """Measurements of one take.

    Attributes
    ----------
    plan : PlannedTake
        Its place in the corpus.
    seconds : float
        Length of its speech.
    moved, drive : MotionCurves
        Curves of the motion, and their parts determined by the speech.
    pose, sound : ndarray
        Mean and standard deviation of each value of the motion (384,) and of the speech (10,).
    wrists : ndarray, shape (T, 2, 3)
        Positions of the wrists in metres, at `FRAME_RATE`.
    """

    plan: PlannedTake
    seconds: float
    moved: MotionCurves
    drive: MotionCurves
    pose: FloatArray
    sound: FloatArray
    wrists: FloatArray


@dataclass(frozen=True, kw_only=True)
class Decided:
    """How closely a curve of the motion follows the speech.

    Attributes
    ----------
    curve : str
        A field of `MotionCurves`.
    explained : float
        Share of its variance that the drive explains, over all frames of all takes; NaN if it never
        changes.
    correlation : float
        Mean over takes of the correlation with the drive; NaN if the curve never changes.
    of_other_speech : float
        The same with the drive of another text of the same speaker and emotion; NaN if nobody
        speaks two.
    takes : int
        Number of takes in which the curve changes, over which the means are taken.
    """

    curve: str
    explained: float
    correlation: float
    of_other_speech: float
    takes: int


@dataclass(frozen=True, kw_only=True)
class ClassifierScore:
    """How often a simple classifier identifies a property of test takes.

    Attributes
    ----------
    what : str
        The property, and what it is predicted from.
    share : float
        Share of test takes identified correctly; NaN without test takes.
    chance : float
        One over the number of classes.
    takes : int
        Number of test takes.
    """

    what: str
    share: float
    chance: float
    takes: int


def read_measured(
    folder: Path, show: Callable[[int, int], None] = lambda done, total: None
) -> tuple[MeasuredTake, ...]:
    """Read all takes of a corpus.

    Raises
    ------
    InputError
        If the folder holds no corpus or one of another version, or a file cannot be read.
    """
    plans = list(planned_takes(read_request(folder)))
    takes = []
    for number, plan in enumerate(plans, start=1):
        takes.append(_measured(folder, plan))
        show(number, len(plans))
    return tuple(takes)


def read_request(folder: Path) -> CorpusRequest:
    """Return the request of the corpus in a folder.

    Raises
    ------
    InputError
        If it holds no corpus, or one from another version of the process.
    """
    path = folder / DESCRIPTION
    content = json.loads(path.read_text("utf-8")) if path.exists() else {}
    if content.get("process_version") != VERSION:
        raise InputError(
            f"the folder holds no corpus of version {VERSION} of the process",
            where=path,
            remedy="Make the corpus again",
        )
    names = [field.name for field in fields(CorpusRequest)]
    return CorpusRequest(**{name: content[name] for name in names})


def correlate_curves(motion: Floats, reference: Floats) -> float:
    """Return the correlation of two curves (T,), over their common frames; NaN for a constant."""
    frames = min(len(motion), len(reference))
    motion, reference = motion[:frames], reference[:frames]
    if frames < 3 or min(np.ptp(motion), np.ptp(reference)) < 1e-9:
        return math.nan
    return float(np.corrcoef(motion, reference)[0, 1])


def _measured(folder: Path, plan: PlannedTake) -> MeasuredTake:
    files = files_of(folder, plan)
    truth = np.load(files["truth"])
    motion = read_bvh(files["motion"])
    body = body_values(motion)
    face = face_values(read_arkit_json(files["face"], motion.frame_rate))
    # The last frame of the face is repeated where rounding made it a frame shorter.
    face = face[np.minimum(np.arange(len(body)), len(face) - 1)]
    speech = read_audio(files["speech"])
    return MeasuredTake(
        plan=plan,
        seconds=speech.duration,
        moved=curves_of(body, face, motion.frame_rate),
        drive=MotionCurves(
            **{name.name: truth[f"drive_{name.name}"] for name in fields(MotionCurves)}
        ),
        pose=_summary(np.concatenate([body, face], axis=1)),
        sound=_summary(_columns(analyse(speech))),
        wrists=wrist_positions(_thinned(body, motion.frame_rate)),
    )


def minutes(takes: Sequence[MeasuredTake]) -> Mapping[Split, float]:
    """Return the minutes of speech for training, validation and testing."""
    return {
        split: sum(take.seconds for take in takes if take.plan.split == split) / 60
        for split in ("train", "validation", "test")
    }


def decided(takes: Sequence[MeasuredTake]) -> tuple[Decided, ...]:
    """Return how closely each curve follows the speech."""
    return tuple(_decided(curve, takes) for curve in CURVES)


def _decided(curve: str, takes: Sequence[MeasuredTake]) -> Decided:
    moved = [getattr(take.moved, curve) for take in takes]
    drive = [getattr(take.drive, curve) for take in takes]
    other = [
        getattr(_other(take, takes).drive, curve)
        if _other(take, takes) is not take
        else np.zeros(0)
        for take in takes
    ]
    own = [correlate_curves(*both) for both in zip(moved, drive, strict=True)]
    swapped = [correlate_curves(*both) for both in zip(moved, other, strict=True)]
    return Decided(
        curve=curve,
        explained=correlate_curves(np.concatenate(moved), np.concatenate(drive)) ** 2,
        correlation=_mean(own),
        of_other_speech=_mean(swapped),
        takes=int(np.isfinite(own).sum()),
    )


def _mean(values: Sequence[float]) -> float:
    """Return the mean of the finite values; NaN if there are none."""
    numbers = [value for value in values if np.isfinite(value)]
    return float(np.mean(numbers)) if numbers else float("nan")


def _other(take: MeasuredTake, takes: Sequence[MeasuredTake]) -> MeasuredTake:
    """Return another text of the same speaker and emotion, or the take itself."""
    alike = [
        other
        for other in takes
        if other.plan.speaker == take.plan.speaker
        and other.plan.emotion == take.plan.emotion
        and other.plan.text != take.plan.text
    ]
    return alike[0] if alike else take


def classifier_scores(takes: Sequence[MeasuredTake]) -> tuple[ClassifierScore, ...]:
    """Return how well the nearest mean of the training takes predicts emotion and speaker."""
    familiar = [take for take in takes if not take.plan.held_out_speaker]
    strangers = [take for take in takes if take.plan.split != "test" or take.plan.held_out_speaker]

    pose, sound = attrgetter("pose"), attrgetter("sound")
    emotion, speaker = attrgetter("plan.emotion"), attrgetter("plan.speaker.name")
    return (
        _classifier_score("emotion from motion, known speakers", familiar, pose, emotion),
        _classifier_score("emotion from motion, held-out speakers", strangers, pose, emotion),
        _classifier_score("emotion from sound, known speakers", familiar, sound, emotion),
        _classifier_score("emotion from sound, held-out speakers", strangers, sound, emotion),
        _classifier_score("speaker from motion", familiar, pose, speaker),
        _classifier_score("speaker from sound", familiar, sound, speaker),
    )


def _classifier_score(
    what: str,
    takes: Sequence[MeasuredTake],
    seen: Callable[[MeasuredTake], FloatArray],
    label: Callable[[MeasuredTake], str],
) -> ClassifierScore:
    train = [take for take in takes if take.plan.split == "train"]
    test = [take for take in takes if take.plan.split == "test"]
    known = np.stack([seen(take) for take in train])
    centre, spread = known.mean(axis=0), known.std(axis=0) + 1e-6
    labels = sorted({label(take) for take in train})
    means = np.stack(
        [np.mean([seen(take) for take in train if label(take) == name], axis=0) for name in labels]
    )
    standard = (means - centre) / spread
    right = [
        labels[int(np.argmin(np.linalg.norm((seen(take) - centre) / spread - standard, axis=1)))]
        == label(take)
        for take in test
    ]
    share = float(np.mean(right)) if right else float("nan")
    return ClassifierScore(what=what, share=share, chance=1 / len(labels), takes=len(test))


def _summary(values: FloatArray) -> FloatArray:
    return np.concatenate([values.mean(axis=0), values.std(axis=0)])


def _thinned(values: FloatArray, frame_rate: float) -> FloatArray:
    """Return the nearest frames at `FRAME_RATE`."""
    moments = np.arange(0, len(values), frame_rate / FRAME_RATE)
    return np.asarray(values[np.minimum(np.round(moments).astype(int), len(values) - 1)])


def _columns(curves: SpeechCurves) -> FloatArray:
    """Return the curves of a take's speech as columns."""
    return np.stack([getattr(curves, field.name) for field in fields(SpeechCurves)], axis=1)
