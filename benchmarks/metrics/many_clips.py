"""Speed of metrics on a great many clips: ``python -m benchmarks.metrics.many_clips``.

Makes a folder of recordings and generated motion, measures it as ``motionjury metrics`` does, first
without a cache and then with the first run's, and prints ``name: value`` lines: wall-clock seconds,
and processor seconds, to which other work of the machine does not add. The motion is the rule-based
generator's for a few synthetic sounds, shifted in time and scaled differently for every clip; the
sounds are shifted for every segment, so that no two are equal.
"""

import argparse
import os
import resource
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from analysis.measurement.presets import PRESETS
from analysis.metrics.score_tables import write_scores
from analysis.metrics.scores import StudyMetrics
from generators.interface import SpeechSegment
from generators.registry import load_generator
from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.segment import EMOTIONS, Segment, write_segments
from studyapp.results.metrics import measure_folders

CONDITIONS: Final = ("ours", "theirs", "older", "static-like")
"""Generated conditions, besides the recordings."""

_SAMPLE_RATE: Final = 16000
_FRAME_RATE: Final = 30.0
_SYLLABLES_PER_SECOND: Final = 4.0


def made_speech(seconds: float, chance: np.random.Generator) -> Audio:
    """Return noise with the loudness and syllables of speech."""
    time_axis = np.arange(round(seconds * _SAMPLE_RATE)) / _SAMPLE_RATE
    starts = np.cumsum(chance.gamma(4, 1 / (4 * _SYLLABLES_PER_SECOND), round(6 * seconds)))
    loudness = np.zeros_like(time_axis)
    for start in starts[starts < seconds - 0.05]:
        burst = slice(int(start * _SAMPLE_RATE), int((start + 0.18) * _SAMPLE_RATE))
        shape = np.hanning(len(loudness[burst]))
        loudness[burst] = np.maximum(loudness[burst], chance.uniform(0.2, 1) * shape)
    voice = np.sin(2 * np.pi * np.cumsum(120 + 25 * np.sin(2 * time_axis)) / _SAMPLE_RATE)
    noise = chance.standard_normal(len(time_axis))
    return Audio((0.4 * loudness * (0.7 * voice + 0.3 * noise)).astype(np.float32), _SAMPLE_RATE)


def make_folders(root: Path, segments: int, seconds: float, patterns: int) -> None:
    """Write recordings, generated motion of `CONDITIONS` and speech into `root`.

    Parameters
    ----------
    root : Path
        Gets ``recorded``, ``generated`` and ``speech``.
    segments : int
        Number of recordings, and of clips of each condition.
    seconds : float
        Length of a clip.
    patterns : int
        Clips that the generator makes; all others are variations of them.
    """
    chance = np.random.default_rng(0)
    generator = load_generator("rule_based")
    speech = [made_speech(seconds, chance) for _ in range(patterns)]
    spoken = [
        Segment(
            name=f"s{number}",
            wav="-",
            start=0,
            end=seconds,
            speaker="made",
            emotion=EMOTIONS[number % len(EMOTIONS)],
        )
        for number in range(patterns)
    ]
    motions = [
        generator.generate(
            SpeechSegment(segment=segment, audio=audio), seed=1, frame_rate=_FRAME_RATE
        )
        for segment, audio in zip(spoken, speech, strict=True)
    ]
    table = []
    for number in range(segments):
        pattern = number % patterns
        name = f"s{number:05d}"
        sound = speech[pattern]
        shifted = np.roll(sound.samples, int(chance.integers(len(sound.samples))))
        write_wav(root / "speech" / f"{name}.wav", Audio(shifted, sound.sample_rate))
        table.append(replace(spoken[pattern], name=name, wav=f"{name}.wav"))
        _write(root / "recorded" / f"{name}.npz", _varied(motions[pattern], chance, 0.0))
        for place, condition in enumerate(CONDITIONS, start=1):
            other = motions[int(chance.integers(patterns))]
            _write(
                root / "generated" / condition / f"{name}.npz", _varied(other, chance, 0.2 * place)
            )
    write_segments(root / "speech", table)


def peak_memory() -> float:
    """Return the largest peak memory of any process of this run, in MiB."""
    own_peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    others = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    return max(own_peak, others) / 1024


def processor_seconds() -> float:
    """Return the processor time used by this process and its finished children."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the folders, measure them twice and print the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clips", type=int, default=10_000)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--preset", action="append", choices=sorted(PRESETS))
    parser.add_argument("--evaluator", action="append", type=Path, default=[])
    args = parser.parse_args(arguments)
    segments = max(1, args.clips // (len(CONDITIONS) + 1))
    clips = segments * (len(CONDITIONS) + 1)
    with tempfile.TemporaryDirectory(prefix="bench-metrics-") as folder:
        root = Path(folder)
        began = time.perf_counter()
        make_folders(root, segments, args.seconds, patterns=min(segments, 40))
        print(f"clips: {clips}")
        print(f"making_s: {time.perf_counter() - began:.1f}", flush=True)
        for run in ("cold", "kept"):
            began, used = time.perf_counter(), processor_seconds()
            metrics = _measured(root, args.preset or tuple(PRESETS), args)
            write_scores(metrics, root / f"{run}.parquet")
            taken = time.perf_counter() - began
            print(f"{run}_s: {taken:.1f}")
            print(f"{run}_clips_per_s: {clips / taken:.1f}")
            print(f"{run}_processor_s: {processor_seconds() - used:.1f}")
            print(f"{run}_peak_mib: {peak_memory():.0f}", flush=True)
        print(f"clip_scores: {len(metrics.clips)}")
        print(f"scores_mib: {(root / 'kept.parquet').stat().st_size / 2**20:.1f}")


def _measured(root: Path, presets: Sequence[str], args: argparse.Namespace) -> StudyMetrics:
    return measure_folders(
        root / "generated",
        root / "recorded",
        root / "speech",
        presets=presets,
        processes=args.processes,
        evaluators=args.evaluator,
        cache=root / "kept",
    )


def _varied(clip: MotionClip, chance: np.random.Generator, amount: float) -> MotionClip:
    """Return the clip with another start, larger or smaller gestures, and a little noise."""
    shift = int(chance.integers(len(clip)))
    size = 1 + amount * chance.uniform(-0.5, 0.5)
    poses = np.roll(clip.poses, shift, axis=0) * np.float32(size)
    poses += chance.normal(0, 0.002, (1, *poses.shape[1:])).astype(np.float32)
    return replace(
        clip,
        poses=poses,
        trans=np.roll(clip.trans, shift, axis=0),
        arkit=None if clip.arkit is None else np.roll(clip.arkit, shift, axis=0),
    )


def _write(path: Path, clip: MotionClip) -> None:
    """Write a clip uncompressed; compression would take most of the time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    face = {} if clip.arkit is None else {"arkit": clip.arkit}
    np.savez(
        path,
        poses=clip.poses.reshape(len(clip), -1),
        trans=clip.trans,
        mocap_frame_rate=np.array(clip.frame_rate),
        **face,  # type: ignore[arg-type]
    )


if __name__ == "__main__":
    main()
