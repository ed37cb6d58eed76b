"""Rendering speed on this machine, compared with alternatives.

``python -m benchmarks.rendering`` measures everything in turns, round after round, on the same mesh
and motion, and takes medians, because other work on the machine varies. Rates are by wall-clock
time. Each of our processes uses one thread; the alternatives use as many as they choose.
"""

import os

from renderer.jobs.making import ONE_THREAD

os.environ.update(ONE_THREAD)  # before NumPy and Mesa load: measured as in a worker

import resource
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from typing import Final

import numpy as np

from benchmarks.rendering.measured import Measured, timed
from benchmarks.rendering.peers import peers, write_posed_mesh
from benchmarks.rendering.sample_motion import gesturing_clip
from motion.audio import Audio, write_wav
from motion.body.model import read_body
from motion.formats import write_clip
from renderer.clip_video import Stage, write_clip_video
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.framing import Camera, frame_clips
from renderer.jobs.making import run_jobs
from renderer.look import Look, default_body
from renderer.pair import composed_frames, write_pair
from renderer.video_jobs import ClipJob, Job, PairJob

SECONDS: Final = 4.0
ROUNDS: Final = 3
PEER_FRAMES: Final = 30
"""Frames of the plain loop, which is slow and leaks some 3 MB with each."""

_CLIPS_PER_PROCESS: Final = 3
"""The first loads libraries, body and shaders, and is not counted."""

_STIMULI, _STIMULUS_SECONDS = 200, 10.0

_LABELS: Final = {
    "clip": "our clip: skin, draw, encode",
    "frames": "our frames, kept without loss for pairs",
    "compose": "our pair composed from kept frames",
    "x264": "x264 and AAC alone, one clip",
    "x264 pair": "x264 and AAC alone, one pair",
    "plain loop": "pair by a plain pyrender loop",
    "patched loop": "the same, shader cache patched",
}


@dataclass(frozen=True, kw_only=True)
class Setting:
    """What is measured: a motion, its files, and its look."""

    folder: Path
    look: Look
    camera: Camera
    body: Path

    @property
    def frame_count(self) -> int:
        """Number of frames of one video."""
        return round(SECONDS * self.look.frame_rate)

    def clip_job(self, name: str) -> ClipJob:
        """Return a job that renders the clip's frames into a file called `name`."""
        return ClipJob(
            name=name, motion=self.folder / "clip.npz", speech=self.folder / "speech.wav",
            start=0.0, end=SECONDS, freeze=(), body=self.body, camera=self.camera, look=self.look,
            frames=self.folder / f"{name}.mkv", video=None,
        )  # fmt: skip

    def pair_job(self, name: str, side: str) -> PairJob:
        """Return a job that pairs the rendered clip `side` with itself."""
        frames = self.folder / f"{side}.mkv"
        return PairJob(
            name=name, left=frames, right=frames, speech=self.folder / "speech.wav",
            start=0.0, end=SECONDS, video=self.folder / f"{name}.mp4", look=self.look,
        )  # fmt: skip


def main() -> None:
    """Measure, and print a table and then ``name: value`` lines."""
    look = Look()
    body = default_body()
    clip = gesturing_clip(SECONDS, look.frame_rate)
    camera = frame_clips([clip], read_body(body), look)
    with tempfile.TemporaryDirectory() as name:
        setting = Setting(folder=Path(name), look=look, camera=camera, body=body)
        write_clip(setting.folder / "clip.npz", clip)
        silence = Audio(np.zeros(round(SECONDS * SOUND_RATE), np.float32), SOUND_RATE)
        write_wav(setting.folder / "speech.wav", silence)
        # This comes first, because a new process's peak includes the memory of this one at its
        # start.
        all_cores = [_one_process_per_core(setting)]
        stage = Stage(body, camera, look)
        posed = setting.folder / "posed.npz"
        write_posed_mesh(posed, stage.body, camera, look, PEER_FRAMES)
        with stage:
            tasks = {**_our_tasks(setting, stage, silence), **peers(posed)}
            runs: dict[str, list[Measured]] = {name: [] for name in tasks}
            for number in range(ROUNDS):
                if number:
                    all_cores.append(_one_process_per_core(setting))
                for name, task in tasks.items():
                    runs[name].append(task())
        print(f"{stage.body.template.shape[0]} vertices, {len(stage.body.faces)} triangles,"
              f" {look.size} x {look.size} pixels a side")  # fmt: skip
    _print(runs, all_cores)


def _one_process_per_core(setting: Setting) -> dict[str, float]:
    """Return frames per second of all cores together, and the largest process' peak in MB."""
    cores = os.cpu_count() or 1
    names = [f"clip{number}" for number in range(cores * _CLIPS_PER_PROCESS)]
    clips: list[Job] = [setting.clip_job(name) for name in names]
    composed: list[Job] = [setting.pair_job(f"pair{name}", name) for name in names]
    outcomes = run_jobs([*clips, *composed], processes=cores)
    failed = [outcome.error for outcome in outcomes if outcome.error]
    if failed:
        raise RuntimeError(f"a job of the benchmark failed: {failed[0]}")
    clip = median(outcome.seconds for outcome in outcomes[cores : len(clips)])
    compose = median(outcome.seconds for outcome in outcomes[len(clips) + cores :])
    frames = cores * setting.frame_count
    return {
        "frames": frames / clip,
        "compose": frames / compose,
        "pair": frames / (2 * clip + compose),
        "peak": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024,
    }


def _our_tasks(setting: Setting, stage: Stage, silence: Audio) -> dict[str, Callable[[], Measured]]:
    """Return the tasks of one of our processes, and encoding alone, by name."""
    clip, pair = setting.clip_job("one"), setting.pair_job("two", "one")
    count, look = setting.frame_count, setting.look
    single = [*stage.video_frames(gesturing_clip(SECONDS, look.frame_rate))]

    video = replace(clip, frames=None, video=setting.folder / "one.mp4")
    return {
        "clip": lambda: timed(count, lambda: write_clip_video(video, stage)),
        "frames": lambda: timed(count, lambda: write_clip_video(clip, stage)),
        "compose": lambda: timed(count, lambda: write_pair(pair)),
        "x264": lambda: timed(count, lambda: _encode(setting, single, look.size, silence)),
        "x264 pair": lambda: _x264_pair(setting, silence),
    }


def _encode(setting: Setting, frames: list[object], width: int, silence: Audio) -> None:
    look = setting.look
    with VideoWriter(
        setting.folder / "alone.mp4", width, look.size, look.frame_rate, silence
    ) as writer:
        for frame in frames:
            writer.write(frame)


def _x264_pair(setting: Setting, silence: Audio) -> Measured:
    """Encode the frames that a pair is composed of, which are already in memory."""
    job = setting.pair_job("two", "one")
    frames: list[object] = [*composed_frames(job.left, job.right, setting.look)]
    return timed(len(frames), lambda: _encode(setting, frames, 2 * setting.look.size, silence))


def _print(
    runs: dict[str, list[Measured]],
    all_cores: list[dict[str, float]],
) -> None:
    """Print the table, then the values for other programs."""
    print(f"{'medians of ' + str(ROUNDS):46} frames/s  CPU ms/frame  peak MB")
    for name, measured in runs.items():
        memory = median(run.peak_mb for run in measured)
        print(
            f"{_LABELS[name]:46} {median(run.rate for run in measured):8.1f}"
            f"  {median(run.milliseconds for run in measured):12.1f}"
            f"  {'' if np.isnan(memory) else round(memory):>7}"
        )
    cores = os.cpu_count() or 1
    ours = {name: median(run[name] for run in all_cores) for name in all_cores[0]}
    pairs = [_pair(*both) for both in zip(runs["frames"], runs["compose"], strict=True)]
    for label, pair_rate in (("one process", median(pairs)), (f"{cores} processes", ours["pair"])):
        print(f"{'our pair: both sides drawn, composed, ' + label:46} {pair_rate:8.1f}")
    print(f"{f'our composing, {cores} processes':46} {ours['compose']:8.1f}")
    print(
        "Ratios to the plain loop take our rate with one process a core, as it uses all cores."
        "\nEach clip serves several pairs, so a study's pairs come nearer to composing's rate."
        "\nSkinning is counted for us, but not for the plain loop, which gets the posed mesh."
    )
    rate = {name: median(run.rate for run in measured) for name, measured in runs.items()}
    composed = zip(runs["compose"], runs["x264 pair"], strict=True)
    frames = _STIMULI * _STIMULUS_SECONDS * Look().frame_rate
    values = {
        "stimuli_200_minutes": frames * (1 / ours["frames"] + 1 / ours["compose"]) / 60,
        "pair_fps_all_cores": ours["pair"],
        "compose_fps_all_cores": ours["compose"],
        "pair_over_plain_loop_one_process": median(pairs) / rate["plain loop"],
        "clip_fps": rate["clip"],
        "pair_fps": median(pairs),
        "plain_loop_fps": rate["plain loop"],
        "patched_loop_fps": rate["patched loop"],
        "x264_fps": rate["x264"],
        "pair_over_plain_loop": median(
            mine["pair"] / loop.rate
            for mine, loop in zip(all_cores, runs["plain loop"], strict=True)
        ),
        "compose_over_x264": median(mine.rate / alone.rate for mine, alone in composed),
        "peak_mb": all_cores[0]["peak"],  # before another program has run
    }
    print()
    for name, value in values.items():
        print(f"{name}: {value:.2f}")


def _pair(frames: Measured, composed: Measured) -> float:
    """Return frames per second of a pair whose sides are not yet rendered."""
    return 1 / (2 / frames.rate + 1 / composed.rate)


if __name__ == "__main__":
    main()
