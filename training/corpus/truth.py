"""The truth about each take of a corpus, as in its folder ``truth``."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.files import replacing
from training.corpus.chance import StrokeChance
from training.corpus.motion_curves import MotionCurves
from training.corpus.speech_curves import Strokes


@dataclass(frozen=True, kw_only=True, eq=False)
class Truth:
    """The truth about a take.

    Attributes
    ----------
    frame_rate : float
        Frames per second of `drive`; that of the take's BVH file.
    drive : MotionCurves
        The part of the motion that speech determines: the process without chance.
    strokes : Strokes
        The strokes that the speech calls for.
    chance : StrokeChance
        Their random variation.
    emotion, text : str
        Its emotion and its text.
    speaker : int
        The speaker's number.
    seed : tuple of int
        Of all random numbers of the take, as `training.corpus.chance.Chance` takes it.
    """

    frame_rate: float
    drive: MotionCurves
    strokes: Strokes
    chance: StrokeChance
    emotion: str
    text: str
    speaker: int
    seed: tuple[int, ...]


def write_truth(path: Path, truth: Truth) -> None:
    """Write `truth` as ``.npz``, in one step; curves as ``drive_*``, in single precision."""
    arrays: dict[str, NDArray[np.generic]] = {
        "frame_rate": np.array(truth.frame_rate),
        "stroke_times": truth.strokes.times,
        "stroke_sizes": truth.strokes.sizes,
        "stroke_gains": truth.chance.gains,
        "stroke_delays": truth.chance.delays,
        "emotion": np.array(truth.emotion),
        "text": np.array(truth.text),
        "speaker": np.array(truth.speaker),
        "seed": np.array(truth.seed, np.int64),
    }
    for field in fields(MotionCurves):
        arrays[f"drive_{field.name}"] = getattr(truth.drive, field.name).astype(np.float32)
    with replacing(path) as draft, draft.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def read_truth(path: Path) -> Truth:
    """Read the known truth of a take.

    Raises
    ------
    InputError
        If the file is no such archive.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return Truth(
                frame_rate=float(archive["frame_rate"]),
                drive=MotionCurves(
                    **{
                        field.name: archive[f"drive_{field.name}"].astype(np.float64)
                        for field in fields(MotionCurves)
                    }
                ),
                strokes=Strokes(times=archive["stroke_times"], sizes=archive["stroke_sizes"]),
                chance=StrokeChance(gains=archive["stroke_gains"], delays=archive["stroke_delays"]),
                emotion=str(archive["emotion"]),
                text=str(archive["text"]),
                speaker=int(archive["speaker"]),
                seed=tuple(int(number) for number in archive["seed"]),
            )
    except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(
            "the file does not hold the truth about a take of a synthetic corpus",
            where=path,
            remedy="Give a file of the folder truth that 'motionjury corpus' wrote",
        ) from error
