"""Making a corpus, in one or several processes, resuming where an earlier run stopped.

A take is its speech, its motion, and the truth about both.
"""

import csv
import io
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np

from motion.audio import SPEECH_RATE, Audio, read_audio, write_wav
from motion.files import replacing, write_text
from motion.formats.beat_tracks import SemanticSpan, write_arkit_json, write_semantic_scores
from motion.formats.bvh_motion import write_bvh
from motion.processes import ProcessPool
from motion.synthesis import speak_as
from training.corpus.chance import Chance
from training.corpus.plan import CorpusRequest, PlannedTake, claim_folder, planned_takes
from training.corpus.process import Process
from training.corpus.speakers import EMOTION_MOTION, spoken_prosody, voice_of
from training.spaces.beat import upper_body_motion

Show = Callable[[int, int], None]
"""Called with the number of finished takes and the number of all takes."""

SPLITS: Final = "splits.csv"
TAKES: Final = "takes.csv"


def make_corpus(
    folder: Path, request: CorpusRequest, *, processes: int = 1, show: Show | None = None
) -> tuple[list[PlannedTake], int]:
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

    Returns
    -------
    (list of PlannedTake, int)
        All takes of the corpus, and the number of them that were made by this call.

    Raises
    ------
    InputError
        If the folder holds another corpus or something else, or espeak-ng is not installed or
        fails.
    """
    claim_folder(folder, request)
    takes = list(planned_takes(request))
    missing = [
        take
        for take in takes
        if not all(path.is_file() for path in files_of(folder, take).values())
    ]
    report = show or (lambda done, total: None)
    existing = len(takes) - len(missing)
    for done, _ in enumerate(_record_all(folder, request, missing, processes), start=existing + 1):
        report(done, len(takes))
    write_text(folder / TAKES, _table(takes))
    splits = [("name", "split"), *((take.name, take.split) for take in takes)]
    write_text(folder / SPLITS, _csv(splits))
    return takes, len(missing)


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


FACE_RATE: Final = 60.0
"""Frames per second of BEAT's facial weights."""

_BEFORE, _AFTER = 0.3, 0.2
"""Seconds of silence around the speech, in addition to the synthesiser's."""
_SPEECH_STREAM: Final = 7
"""Random stream of a take's speech, separate from that of its motion."""
_FULL_SCORE_SIZE: Final = 2.0
"""Size of a stroke that scores 1."""


_ENDINGS: Final = MappingProxyType(
    {
        "speech": ".wav",
        "motion": ".bvh",
        "face": ".json",
        "semantic": ".txt",
        "transcript": ".lab",
    }
)


def files_of(corpus: Path, take: PlannedTake) -> dict[str, Path]:
    """Return the paths of the files of `take` in a corpus, which has a folder for each speaker."""
    stem = corpus / str(take.speaker.number) / take.name
    files = {role: stem.with_suffix(ending) for role, ending in _ENDINGS.items()}
    return files | {"truth": corpus / "truth" / f"{take.name}.npz"}


def _record(corpus: Path, take: PlannedTake, frame_rate: float) -> None:
    """Write the files of a take, each in one step."""
    files = files_of(corpus, take)
    write_wav(files["speech"], _speak(take))
    # The process reads the file's samples, so that its results can be recomputed from the file.
    process = Process.from_speech(read_audio(files["speech"]), take.emotion, take.speaker)
    chance = Chance(seed=take.seed)
    write_bvh(files["motion"], upper_body_motion(process.body(frame_rate, chance), frame_rate))
    write_arkit_json(files["face"], process.face(FACE_RATE, chance), FACE_RATE)
    write_semantic_scores(files["semantic"], _semantic_spans(process, chance))
    write_text(files["transcript"], f"{take.text}\n")
    drive = asdict(process.drive(frame_rate))
    strokes = process.strokes
    stroke_chance = chance.strokes(len(strokes.times))
    with replacing(files["truth"]) as draft:
        np.savez_compressed(
            draft,
            allow_pickle=False,
            frame_rate=frame_rate,
            stroke_times=strokes.times,
            stroke_sizes=strokes.sizes,
            stroke_gains=stroke_chance.gains,
            stroke_delays=stroke_chance.delays,
            emotion=take.emotion,
            text=take.text,
            speaker=take.speaker.number,
            seed=take.seed,
            **{f"drive_{name}": curve.astype(np.float32) for name, curve in drive.items()},
        )


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
