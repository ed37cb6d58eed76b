"""Making a corpus, in one or several processes, resuming where an earlier run stopped.

A take is its speech, its motion, and the truth about both. Motion has all 75 joints of BEAT's
files, in their order, including limb ends that never move.
"""

from __future__ import annotations

import csv
import io
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np

from motion.audio import SPEECH_RATE, Audio, read_audio, write_wav
from motion.files import write_text
from motion.formats.beat_tracks import SemanticSpan, write_arkit_json, write_semantic_scores
from motion.formats.bvh_motion import BvhJoint, write_bvh
from motion.processes import ProcessPool
from motion.synthesis import speak_as
from training.corpus.chance import Chance
from training.corpus.plan import CorpusRequest, PlannedTake, claim_folder, planned_takes
from training.corpus.process import Process
from training.corpus.speakers import EMOTION_MOTION, spoken_prosody, voice_of
from training.corpus.truth import Truth, write_truth
from training.spaces.beat import BEAT_SKELETON, upper_body_motion

Show = Callable[[int, int], None]
"""Called with the number of finished takes and the number of all takes."""

SPLITS: Final = "splits.csv"
TAKES: Final = "takes.csv"


@dataclass(frozen=True, kw_only=True)
class CorpusResult:
    """The takes of a corpus.

    Attributes
    ----------
    takes : tuple of PlannedTake
        All takes of the corpus.
    new_takes : int
        Number of takes made by this call; the others existed already.
    """

    takes: tuple[PlannedTake, ...]
    new_takes: int


def make_corpus(
    folder: Path, request: CorpusRequest, *, processes: int = 1, show: Show | None = None
) -> CorpusResult:
    """Make a corpus in `folder`; existing takes are kept.

    Parameters
    ----------
    folder : Path
        The corpus' folder; created if missing.
    request : CorpusRequest
        The request. Equal requests give equal bytes with the same version of espeak-ng.
    processes : int
        Number of processes.
    show : callable, optional
        Called with the progress.

    Raises
    ------
    InputError
        If the folder holds another corpus or something else, or espeak-ng is not installed or
        fails.
    """
    claim_folder(folder, request)
    takes = tuple(planned_takes(request))
    missing = [take for take in takes if not RecordingFiles.of(folder, take).complete]
    report = show or (lambda done, total: None)
    existing = len(takes) - len(missing)
    for done, _ in enumerate(_record_all(folder, request, missing, processes), start=existing + 1):
        report(done, len(takes))
    write_text(folder / TAKES, _table(takes))
    splits = [("name", "split"), *((take.name, take.split) for take in takes)]
    write_text(folder / SPLITS, _csv(splits))
    return CorpusResult(takes=takes, new_takes=len(missing))


def _record_all(
    folder: Path, request: CorpusRequest, takes: Sequence[PlannedTake], processes: int
) -> Iterator[None]:
    """Make the takes, and yield after each."""
    record_take = partial(_record, folder, frame_rate=request.frame_rate)
    if processes == 1 or len(takes) < 2:
        for take in takes:
            record_take(take)
            yield
        return
    with ProcessPool(min(processes, len(takes))) as pool:
        for future in as_completed([pool.submit(record_take, take) for take in takes]):
            yield future.result()


def _table(takes: Sequence[PlannedTake]) -> str:
    header = (
        "name", "speaker", "emotion", "take", "split", "unheard", "held_out_speaker", "text",
    )  # fmt: skip
    rows = [
        (
            take.name, take.speaker.number, take.emotion, take.take, take.split,
            int(take.unheard), int(take.held_out_speaker), take.text,
        )
        for take in takes
    ]  # fmt: skip
    return _csv([header, *rows])


def _csv(rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


Offset = tuple[float, float, float]

_FINGER_TIPS: Final = MappingProxyType(
    {
        "HandMiddle": (2, 0, 0),
        "HandRing": (2, 0, -0.2),
        "HandPinky": (1.7, 0, -0.4),
        "HandIndex": (1.7, 0, 0.2),
        "HandThumb": (2.2, 0.3, 0.9),
    }
)
"""Offsets from the last joint of a left finger to its tip, in centimetres."""

_LIMB_ENDS: Final = MappingProxyType(
    {
        "Head": ("HeadEnd", (0.0, 10.0, 0.0)),
        **{
            f"{side}{finger}3": (f"{side}{finger}4", (sign * x, y, z))
            for side, sign in (("Right", -1.0), ("Left", 1.0))
            for finger, (x, y, z) in _FINGER_TIPS.items()
        },
        **{f"{side}ToeBase": (f"{side}ToeBaseEnd", (0.0, 0.0, 14.0)) for side in ("Right", "Left")},
    }
)
"""The end of a limb and its offset, by the limb's last joint."""

_LEG: Final = ("UpLeg", "Leg", "Foot", "ToeBase")


def _full_skeleton() -> tuple[BvhJoint, ...]:
    joints: list[BvhJoint] = []
    places: dict[str, int] = {}

    def add(joint: BvhJoint, parent: str, offset: Offset) -> None:
        parent_index = places[parent] if parent else -1
        places[joint.name] = len(joints)
        joints.append(replace(joint, parent=parent_index, offset=offset))

    # BEAT's files have the legs last.
    for joint in sorted(BEAT_SKELETON, key=lambda joint: joint.name.endswith(_LEG)):
        parent = BEAT_SKELETON[joint.parent].name if joint.parent >= 0 else ""
        offset = joint.offset
        if joint.name.endswith("ToeBase"):
            # BEAT's foot has one more joint, at the height of the toes.
            forefoot = joint.name.replace("ToeBase", "ForeFoot")
            x, y, z = offset
            add(replace(joint, name=forefoot), parent, (x, y, 0.0))
            parent, offset = forefoot, (0.0, 0.0, z)
        add(joint, parent, offset)
        if joint.name in _LIMB_ENDS:
            name, end_offset = _LIMB_ENDS[joint.name]
            add(replace(joint, name=name), joint.name, end_offset)
    return tuple(joints)


FULL_SKELETON: Final = _full_skeleton()
"""The joints of BEAT's files, root first, depth first; offsets in centimetres."""

FACE_RATE: Final = 60.0
"""Frames per second of BEAT's facial weights."""

_BEFORE, _AFTER = 0.3, 0.2
"""Seconds of silence around the speech, in addition to the synthesiser's."""
_SPEECH_STREAM: Final = 7
"""Random stream of a take's speech, separate from that of its motion."""
_FULL_SCORE_SIZE: Final = 2.0
"""Size of a stroke that scores 1."""


@dataclass(frozen=True, kw_only=True)
class RecordingFiles:
    """The paths of a take's files.

    Attributes
    ----------
    speech, motion, face, semantic, transcript, truth : Path
        WAV, BVH, JSON, two text files and ``.npz``; the truth is written last.
    """

    speech: Path
    motion: Path
    face: Path
    semantic: Path
    transcript: Path
    truth: Path

    @classmethod
    def of(cls, corpus: Path, take: PlannedTake) -> RecordingFiles:
        """Return the paths of the files of `take` in the folder of a corpus."""
        stem = corpus / take.folder / take.name
        return cls(
            speech=stem.with_suffix(".wav"),
            motion=stem.with_suffix(".bvh"),
            face=stem.with_suffix(".json"),
            semantic=stem.with_suffix(".txt"),
            transcript=stem.with_suffix(".lab"),
            truth=corpus / "truth" / f"{take.name}.npz",
        )

    @property
    def complete(self) -> bool:
        """Whether all of them exist."""
        return all(getattr(self, field.name).is_file() for field in fields(self))


def _record(corpus: Path, take: PlannedTake, frame_rate: float) -> None:
    """Write the files of a take, each in one step."""
    files = RecordingFiles.of(corpus, take)
    write_wav(files.speech, _speak(take))
    # The process reads the file's samples, so that its results can be recomputed from the file.
    process = Process.from_speech(read_audio(files.speech), take.emotion, take.speaker)
    chance = Chance(seed=take.seed)
    write_bvh(
        files.motion, upper_body_motion(process.body(frame_rate, chance), frame_rate, FULL_SKELETON)
    )
    write_arkit_json(files.face, process.face(FACE_RATE, chance), FACE_RATE)
    write_semantic_scores(files.semantic, _semantic_spans(process, chance))
    write_text(files.transcript, f"{take.text}\n")
    strokes = process.strokes
    truth = Truth(
        frame_rate=frame_rate,
        drive=process.drive(frame_rate),
        strokes=strokes,
        chance=chance.strokes(len(strokes.times)),
        emotion=take.emotion,
        text=take.text,
        speaker=take.speaker.number,
        seed=take.seed,
    )
    write_truth(files.truth, truth)


def _speak(take: PlannedTake) -> Audio:
    """Speak a take's text, with a short silence before and after it."""
    random = np.random.default_rng([*take.seed, _SPEECH_STREAM])
    prosody = spoken_prosody(take.emotion, take.speaker.number, random)
    with tempfile.TemporaryDirectory() as folder:
        voice = voice_of(take.speaker.number).name
        speech = speak_as(take.text, prosody, Path(folder) / "speech.wav", voice)
    lead, tail = (
        np.zeros(round(seconds * SPEECH_RATE), np.float32) for seconds in (_BEFORE, _AFTER)
    )
    return Audio(np.concatenate([lead, speech.samples, tail]), SPEECH_RATE)


def _semantic_spans(process: Process, chance: Chance) -> Iterator[SemanticSpan]:
    """Yield the performed strokes as BEAT annotates gestures."""
    tempo = EMOTION_MOTION[process.emotion].tempo
    speaker, strokes = process.speaker, process.strokes
    stroke_chance = chance.strokes(len(strokes.times))
    sizes = strokes.sizes * stroke_chance.gains.max(axis=1)
    for arrival, size in zip(strokes.times + stroke_chance.delays, sizes, strict=True):
        if size > 0:
            start = max(arrival - speaker.attack / tempo, 0.0)
            end = min(arrival + speaker.release / tempo, process.duration)
            yield SemanticSpan(start=start, end=end, score=min(size / _FULL_SCORE_SIZE, 1.0))
