"""What a rendering process does: jobs in, outcomes out."""

from __future__ import annotations

import signal
import sys
import time
from contextlib import ExitStack
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

from motion.errors import InputError
from renderer.jobs.job import ClipJob, DubJob, Job, Outcome, PairJob

if TYPE_CHECKING:
    from renderer.clip_video import Stage


def work(pipe: Connection) -> None:
    """Do the jobs that come through `pipe`, one after the other, until it is closed."""
    # Ctrl-C reaches all processes of a terminal; the parent decides, and ends this one by
    # SIGTERM, which must unwind the stack so that temporary files are removed.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    with Stages() as stages:
        while True:
            try:
                job = pipe.recv()
            except (EOFError, ConnectionError):
                return
            try:
                pipe.send(do_job(job, stages))
            except ConnectionError:  # nobody waits for it any more
                return


class Stages:
    """The stage of the last clip job, kept for the next one if it is to look the same."""

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._key: tuple[Any, ...] | None = None
        self._stage: Stage | None = None

    def __enter__(self) -> Stages:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def of(self, job: ClipJob) -> Stage:
        """Return a stage with the body, camera and look of `job`."""
        # Imported here: pair jobs need neither OpenGL nor a body.
        from renderer.avatars import default_body
        from renderer.clip_video import Stage

        key = (job.body, job.camera, job.look)
        if self._stage is None or self._key != key:
            self._stack.close()
            self._key, self._stage = None, None
            self._stage = self._stack.enter_context(
                Stage(job.body or default_body(job.look.avatar), job.camera, job.look)
            )
            self._key = key
        return self._stage


def do_job(job: Job, stages: Stages) -> Outcome:
    """Do `job` and return what became of it.

    What neither the person's input nor the machine is to blame for is raised.
    """
    began = time.perf_counter()
    error = None
    try:
        if isinstance(job, ClipJob):
            _do_clip(job, stages)
        elif isinstance(job, DubJob):
            _do_dub(job)
        else:
            _do_pair(job)
    except InputError as problem:
        error = str(problem)
    except OSError as problem:
        error = f"{type(problem).__name__}: {problem}"
    return Outcome(name=job.name, error=error, seconds=time.perf_counter() - began)


def _do_clip(job: ClipJob, stages: Stages) -> None:
    from renderer.clip_video import write_clip_video

    write_clip_video(
        stages.of(job),
        motion=job.motion,
        speech=job.speech,
        start=job.start,
        end=job.end,
        frozen=job.freeze,
        frames=job.frames,
        video=job.video,
    )


def _do_dub(job: DubJob) -> None:
    from renderer.video.dub import write_dubbed

    write_dubbed(
        picture=job.picture,
        speech=job.speech,
        start=job.start,
        end=job.end,
        seconds=job.seconds,
        video=job.video,
    )


def _do_pair(job: PairJob) -> None:
    from renderer.pair import write_pair

    write_pair(
        left=job.left,
        right=job.right,
        speech=job.speech,
        start=job.start,
        end=job.end,
        video=job.video,
        look=job.look,
    )


def _leave(number: int, frame: object) -> None:
    """End the process by unwinding its stack."""
    sys.exit(128 + number)
