"""Rendering jobs as plain data, and how a process does them."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from motion.errors import InputError
from renderer.framing import Camera
from renderer.look import Look

if TYPE_CHECKING:
    from renderer.clip_video import Stage


@dataclass(frozen=True, kw_only=True)
class _VideoJob:
    """What all jobs have.

    Attributes
    ----------
    name : str
        Identifies its outcome.
    speech : Path
        The speech of the video.
    start, end : float
        The excerpt of the speech in seconds.
    """

    name: str
    speech: Path
    start: float
    end: float

    @property
    def inputs(self) -> tuple[Path, ...]:
        """Files of other jobs that it is made from."""
        return ()

    @property
    def outputs(self) -> tuple[Path, ...]:
        """Files that other jobs may be made from."""
        return ()


@dataclass(frozen=True, kw_only=True)
class ClipJob(_VideoJob):
    """A motion clip to be rendered as a video with its speech, and as lossless frames.

    Attributes
    ----------
    motion : Path
        The clip; it begins with the excerpt of the speech.
    freeze : tuple of str
        Channels to hold still.
    body : Path or None
        The body model; None for the default body.
    camera, look
        What all stimuli of the study share.
    frames : Path or None
        Where to write the lossless frames; None if no pair is composed from them.
    video : Path or None
        Where to write the video; None if only pairs are shown.
    """

    motion: Path
    freeze: tuple[str, ...]
    body: Path | None
    camera: Camera
    look: Look
    frames: Path | None
    video: Path | None

    @property
    def outputs(self) -> tuple[Path, ...]:
        """The files that it writes."""
        return tuple(path for path in (self.frames, self.video) if path is not None)


@dataclass(frozen=True, kw_only=True)
class DubJob(_VideoJob):
    """A rendered clip to be given another speech.

    Attributes
    ----------
    picture : Path
        The video of a clip job.
    seconds : float
        Length of the sound; silence follows a shorter excerpt.
    video : Path
        Where to write.
    """

    picture: Path
    seconds: float
    video: Path

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The video of the clip job."""
        return (self.picture,)


@dataclass(frozen=True, kw_only=True)
class PairJob(_VideoJob):
    """Two rendered clips to be shown side by side.

    Attributes
    ----------
    left, right : Path
        Lossless frames of clip jobs.
    video : Path
        Where to write.
    look : Look
        The study's look.
    """

    left: Path
    right: Path
    video: Path
    look: Look

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The frames of both clip jobs."""
        return (self.left, self.right)


Job = ClipJob | DubJob | PairJob


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """The outcome of a job.

    Attributes
    ----------
    name : str
        The job's.
    error : str or None
        Why it failed; None where it did not.
    because_of : str or None
        The clip job whose failure made this one impossible.
    seconds : float
        How long it took.
    """

    name: str
    error: str | None = None
    because_of: str | None = None
    seconds: float = 0.0


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
        # Imported here: pair jobs need neither OpenGL nor a body.
        from renderer.clip_video import Stage
        from renderer.look import default_body

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
    """Do `job` and return its outcome.

    Errors other than in input or by the operating system are raised.
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
        stages.stage_for(job),
        motion=job.motion,
        speech=job.speech,
        start=job.start,
        end=job.end,
        frozen=job.freeze,
        frames=job.frames,
        video=job.video,
    )


def _do_dub(job: DubJob) -> None:
    from renderer.stream_copy import write_dubbed

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
