"""How fast videos are made on this machine, beside the loop that research code writes.

``python -m renderer.benchmark`` measures everything in turns, round after round, on the same mesh
and motion, and takes medians, because other work on the machine comes and goes. Rates are by the
clock. One of our processes uses one thread; pyrender's loop may use all cores.
"""

from __future__ import annotations

import os

from renderer.threads import ONE_THREAD

os.environ.update(ONE_THREAD)  # before NumPy and Mesa load: measured as in a worker

import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median
from typing import Final

import numpy as np

from motion.audio import Audio, write_wav
from motion.body import read_body
from motion.formats import write_clip
from renderer.bench.edges import edge_errors
from renderer.bench.sample_motion import gesturing_clip
from renderer.body_asset import default_body
from renderer.clip_video import Stage, write_clip_video
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.frames import looking
from renderer.framing import Camera, frame_clips
from renderer.job import ClipJob, Job, PairJob
from renderer.jobs import run_jobs
from renderer.look import Look
from renderer.pair import composed_frames, write_pair
from renderer.surface import surface_colours

SECONDS: Final = 4.0
ROUNDS: Final = 3
PLAIN_FRAMES: Final = 30
"""Frames of the plain loop, which is slow and loses some 3 MB with each frame."""

_JOBS_PER_PROCESS: Final = 3


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One run: frames per second by the clock, processor milliseconds a frame, peak memory."""

    rate: float
    milliseconds: float
    peak_mb: float = float("nan")


@dataclass(frozen=True, kw_only=True)
class Setting:
    """What is measured: a motion, its files, and how it looks."""

    folder: Path
    look: Look
    camera: Camera
    body: Path

    @property
    def frame_count(self) -> int:
        """Frames of one video."""
        return round(SECONDS * self.look.frame_rate)

    def clip_job(self, name: str) -> ClipJob:
        """Return a job that makes the clip, called `name`."""
        return ClipJob(
            name=name, motion=self.folder / "clip.npz", speech=self.folder / "speech.wav",
            start=0.0, end=SECONDS, freeze=(), body=self.body, camera=self.camera, look=self.look,
            frames=self.folder / f"{name}.mkv", video=self.folder / f"{name}.mp4",
        )  # fmt: skip

    def pair_job(self, name: str, side: str) -> PairJob:
        """Return a job that puts the rendered clip `side` beside itself."""
        frames = self.folder / f"{side}.mkv"
        return PairJob(
            name=name, left=frames, right=frames, speech=self.folder / "speech.wav",
            start=0.0, end=SECONDS, video=self.folder / f"{name}.mp4", look=self.look,
        )  # fmt: skip


def main() -> None:
    """Measure, and print a table and then one ``name: value`` a line."""
    look = Look()
    body = default_body()
    clip = gesturing_clip(SECONDS, look.frame_rate)
    camera = frame_clips([clip], read_body(body), look)
    with tempfile.TemporaryDirectory() as name:
        setting = Setting(folder=Path(name), look=look, camera=camera, body=body)
        write_clip(setting.folder / "clip.npz", clip)
        silence = Audio(np.zeros(round(SECONDS * SOUND_RATE), np.float32), SOUND_RATE)
        write_wav(setting.folder / "speech.wav", silence)
        per_core, peak = _one_process_per_core(setting)
        stage = Stage(body, camera, look)
        edges = edge_errors(stage, camera, stage.body.vertices(clip, slice(0, 1))[0])
        _write_for_stock_loop(setting, stage)
        with stage:
            runs = _in_turns(setting, stage, silence)
    _print(runs, per_core, peak, edges)


def _one_process_per_core(setting: Setting) -> tuple[dict[str, float], float]:
    """Return frames per second of all cores together, and the largest process's peak in MB."""
    cores = os.cpu_count() or 1
    names = [f"clip{number}" for number in range(cores * _JOBS_PER_PROCESS)]
    jobs: list[Job] = [setting.clip_job(name) for name in names]
    jobs += [setting.pair_job(f"pair{name}", name) for name in names]
    outcomes = run_jobs(jobs, processes=cores)
    failed = [outcome.error for outcome in outcomes if outcome.error]
    if failed:
        raise RuntimeError(f"a job of the benchmark failed: {failed[0]}")
    rates = {}
    for kind in ("clip", "compose"):
        part = outcomes[: len(names)] if kind == "clip" else outcomes[len(names) :]
        # Not each process's first one, in which it loads libraries, body and shaders.
        seconds = median(outcome.seconds for outcome in part[cores:])
        rates[kind] = cores * setting.frame_count / seconds
    return rates, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def _write_for_stock_loop(setting: Setting, stage: Stage) -> None:
    """Leave the posed mesh, its colours and the camera for the other process."""
    clip = gesturing_clip(PLAIN_FRAMES / setting.look.frame_rate, setting.look.frame_rate)
    colours = surface_colours(stage.body)[:, :3]
    camera = setting.camera
    np.savez(
        setting.folder / "stock.npz",
        vertices=stage.body.vertices(clip),
        faces=stage.body.faces,
        colours=np.round(colours * 255).astype(np.uint8),
        camera=looking(np.array(camera.eye), np.array(camera.target)),
        field_of_view=camera.field_of_view,
        size=setting.look.size,
        frame_rate=setting.look.frame_rate,
    )


def _in_turns(setting: Setting, stage: Stage, silence: Audio) -> dict[str, list[Measured]]:
    """Return each task's runs, one a round."""
    clip, pair = setting.clip_job("one"), setting.pair_job("two", "one")
    count, look = setting.frame_count, setting.look
    single = [*stage.video_frames(gesturing_clip(SECONDS, look.frame_rate))]
    tasks: dict[str, Callable[[], Measured]] = {
        "clip": lambda: _timed(count, lambda: write_clip_video(
            stage, motion=clip.motion, speech=clip.speech, start=clip.start, end=clip.end,
            frozen=(), frames=clip.frames, video=clip.video,
        )),
        "compose": lambda: _timed(count, lambda: write_pair(
            left=pair.left, right=pair.right, speech=pair.speech, start=pair.start,
            end=pair.end, video=pair.video, look=look,
        )),
        "x264": lambda: _timed(count, lambda: _encode(setting, single, look.size, silence)),
        "x264 pair": lambda: _x264_pair(setting, silence),
        "plain loop": partial(_stock_loop, setting),
        "mended loop": partial(_stock_loop, setting, "--mended"),
    }  # fmt: skip
    runs: dict[str, list[Measured]] = {name: [] for name in tasks}
    for _ in range(ROUNDS):
        for name, task in tasks.items():
            runs[name].append(task())
    return runs


def _timed(frames: int, task: Callable[[], object]) -> Measured:
    wall, busy = time.perf_counter(), time.process_time()
    task()
    wall, busy = time.perf_counter() - wall, time.process_time() - busy
    return Measured(rate=frames / wall, milliseconds=1000 * busy / frames)


def _encode(setting: Setting, frames: list[object], width: int, silence: Audio) -> None:
    look = setting.look
    with VideoWriter(
        setting.folder / "alone.mp4", width, look.size, look.frame_rate, silence
    ) as writer:
        for frame in frames:
            writer.write(frame)


def _x264_pair(setting: Setting, silence: Audio) -> Measured:
    """Encode the very frames that a pair is composed of, already in memory."""
    job = setting.pair_job("two", "one")
    frames: list[object] = [*composed_frames(job.left, job.right, setting.look.size)]
    return _timed(len(frames), lambda: _encode(setting, frames, 2 * setting.look.size, silence))


def _stock_loop(setting: Setting, *options: str) -> Measured:
    """Run the stock loop in a process of its own, with the threads it takes by itself."""
    environment = {name: text for name, text in os.environ.items() if name not in ONE_THREAD}
    done = subprocess.run(  # noqa: S603 - our own module
        [sys.executable, "-m", "renderer.bench.stock_loop", setting.folder / "stock.npz", *options],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    result = json.loads(done.stdout.splitlines()[-1])
    return Measured(
        rate=result["frames"] / result["seconds"],
        milliseconds=1000 * result["busy"] / result["frames"],
        peak_mb=result["peak_mb"],
    )


def _print(
    runs: dict[str, list[Measured]],
    per_core: dict[str, float],
    peak: float,
    edges: tuple[float, float],
) -> None:
    """Print the table, then the values that others read."""
    said = {
        "clip": "our clip: skin, draw, encode twice",
        "compose": "our pair composed from rendered clips",
        "x264": "x264 and AAC alone, one clip",
        "x264 pair": "x264 and AAC alone, one pair",
        "plain loop": f"pair by a plain pyrender loop, {PLAIN_FRAMES} frames",
        "mended loop": "the same, shader cache mended",
    }
    print(f"{'one process (medians of ' + str(ROUNDS) + ')':44} frames/s  CPU ms/frame  peak MB")
    for name, measured in runs.items():
        memory = median(run.peak_mb for run in measured)
        print(
            f"{said[name]:44} {median(run.rate for run in measured):8.1f}"
            f"  {median(run.milliseconds for run in measured):12.1f}"
            f"  {'' if np.isnan(memory) else round(memory):>7}"
        )
    pairs = [_pair(*both) for both in zip(runs["clip"], runs["compose"], strict=True)]
    print(f"{'our pair from motion (two clips, composed)':44} {median(pairs):8.1f}")
    cores = os.cpu_count() or 1
    print(f"\nall {cores} cores, a process each: clip {per_core['clip']:.1f}, pair composed"
          f" {per_core['compose']:.1f} frames/s; largest process {peak:.0f} MB")  # fmt: skip
    print("pair_fps counts both clips' drawing; each clip serves many pairs, so a study's pairs"
          " come\nnearer to the composing rate. The loops are given the posed mesh.\n")  # fmt: skip
    rate = {name: median(run.rate for run in measured) for name, measured in runs.items()}
    loops = [run.rate for run in runs["plain loop"]]
    composed = zip(runs["compose"], runs["x264 pair"], strict=True)
    values = {
        "clip_fps": rate["clip"],
        "pair_fps": median(pairs),
        "plain_loop_fps": rate["plain loop"],
        "mended_loop_fps": rate["mended loop"],
        "x264_fps": rate["x264"],
        "pair_over_plain_loop": median(
            pair / loop for pair, loop in zip(pairs, loops, strict=True)
        ),
        "compose_over_x264": median(ours.rate / alone.rate for ours, alone in composed),
        "edge_rmse": edges[0],
        "edge_rmse_msaa4": edges[1],
        "peak_mb": peak,
    }
    for name, value in values.items():
        print(f"{name}: {value:.2f}")


def _pair(clip: Measured, composed: Measured) -> float:
    """Return frames per second of a pair of which nothing is rendered yet."""
    return 1 / (2 / clip.rate + 1 / composed.rate)


if __name__ == "__main__":
    main()
