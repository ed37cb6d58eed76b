"""Jobs of making videos, as plain data, and their outcomes."""

from dataclasses import dataclass
from pathlib import Path

from renderer.framing import Camera
from renderer.look import Look


@dataclass(frozen=True, kw_only=True)
class _VideoJob:
    """Common fields of all jobs.

    Attributes
    ----------
    name : str
        Name that identifies the outcome.
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
        The clip, which starts with the excerpt of the speech.
    freeze : tuple of str
        Channels to hold still, see `motion.clip.freeze`.
    body : Path or None
        The body model; None for the look's avatar.
    camera, look
        Camera and look, which all stimuli of the study share.
    frames : Path or None
        File for lossless frames; None if no pair is composed from them.
    video : Path or None
        File for the video, ``round((end - start) * frame_rate)`` frames; None if only pairs are
        shown.
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
        Length of the sound: a shorter excerpt is padded with silence, so that the length of a file
        does not reveal its speech.
    video : Path
        The file to write.
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
        The file to write.
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
        The job's name.
    error : str or None
        Why it failed; None if it succeeded.
    because_of : str or None
        The clip job whose failure made this one impossible.
    seconds : float
        Duration of the job.
    """

    name: str
    error: str | None = None
    because_of: str | None = None
    seconds: float = 0.0
