"""Doing rendering jobs in one process, one after the other."""

from __future__ import annotations

import time
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from motion.errors import InputError
from renderer.look import default_body
from renderer.pair import write_pair
from renderer.stream_copy import write_dubbed
from renderer.video_jobs import ClipJob, DubJob, Job, Outcome

if TYPE_CHECKING:
    from renderer.clip_video import Stage


class Stages:
    """The stage of the last clip job, reused if the next one has the same look."""

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._key: tuple[Any, ...] | None = None
        self._stage: Stage | None = None

    def __enter__(self) -> Stages:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def stage_for(self, job: ClipJob) -> Stage:
        """Return a stage with the body, camera and look of `job`."""
        from renderer.clip_video import Stage

        key = (job.body, job.camera, job.look)
        if self._stage is None or self._key != key:
            self._stack.close()
            self._key, self._stage = None, None
            body = job.body or default_body(job.look.avatar)
            self._stage = self._stack.enter_context(Stage(body, job.camera, job.look))
            self._key = key
        return self._stage


def do_job(job: Job, stages: Stages) -> Outcome:
    """Do `job` and return its outcome.

    Errors in the input or of the operating system are part of the outcome; others are raised.
    """
    began = time.perf_counter()
    error = None
    try:
        if isinstance(job, ClipJob):
            # Imported here: only clips need OpenGL.
            from renderer.clip_video import write_clip_video

            write_clip_video(job, stages.stage_for(job))
        elif isinstance(job, DubJob):
            write_dubbed(job)
        else:
            write_pair(job)
    except InputError as problem:
        error = str(problem)
    except OSError as problem:
        error = f"{type(problem).__name__}: {problem}"
    return Outcome(name=job.name, error=error, seconds=time.perf_counter() - began)
