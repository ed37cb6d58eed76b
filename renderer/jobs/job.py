"""Videos to make, as plain data, and what became of each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from renderer.framing import Camera
from renderer.look import Look


@dataclass(frozen=True, kw_only=True)
class ClipJob:
    """One motion clip to be made into a video with its speech, and into lossless frames.

    Attributes
    ----------
    name : str
        What its outcome is called.
    motion, speech : Path
        The clip, and what is heard.
    start, end : float
        The excerpt of the speech in seconds; the motion begins with it.
    freeze : tuple of str
        Channels to hold still.
    body : Path or None
        The body model; None for the default body.
    camera, look
        What all stimuli of the study share.
    frames : Path or None
        Where to write the lossless frames; None where no pair is composed from them.
    video : Path or None
        Where to write the video; None where only pairs are shown.
    """

    name: str
    motion: Path
    speech: Path
    start: float
    end: float
    freeze: tuple[str, ...]
    body: Path | None
    camera: Camera
    look: Look
    frames: Path | None
    video: Path | None

    @property
    def needs(self) -> tuple[Path, ...]:
        """Files of other jobs that it is made from: none."""
        return ()

    @property
    def makes(self) -> tuple[Path, ...]:
        """Files that other jobs may be made from."""
        return tuple(path for path in (self.frames, self.video) if path is not None)


@dataclass(frozen=True, kw_only=True)
class DubJob:
    """A rendered clip to be given another speech.

    Attributes
    ----------
    name : str
        What its outcome is called.
    picture : Path
        The video that a clip job left.
    speech : Path
        What is heard instead.
    start, end : float
        The excerpt of the speech in seconds.
    seconds : float
        How long the sound lasts; silence follows a shorter excerpt.
    video : Path
        Where to write.
    """

    name: str
    picture: Path
    speech: Path
    start: float
    end: float
    seconds: float
    video: Path

    @property
    def needs(self) -> tuple[Path, ...]:
        """Files of other jobs that it is made from."""
        return (self.picture,)

    @property
    def makes(self) -> tuple[Path, ...]:
        """Files that other jobs may be made from: none."""
        return ()


@dataclass(frozen=True, kw_only=True)
class PairJob:
    """Two rendered clips to be put side by side.

    Attributes
    ----------
    name : str
        What its outcome is called.
    left, right : Path
        Lossless frames that clip jobs left.
    speech : Path
        What is heard.
    start, end : float
        The excerpt of the speech in seconds.
    video : Path
        Where to write.
    look : Look
        The study's look.
    """

    name: str
    left: Path
    right: Path
    speech: Path
    start: float
    end: float
    video: Path
    look: Look

    @property
    def needs(self) -> tuple[Path, ...]:
        """Files of other jobs that it is made from."""
        return (self.left, self.right)

    @property
    def makes(self) -> tuple[Path, ...]:
        """Files that other jobs may be made from: none."""
        return ()


Job = ClipJob | DubJob | PairJob


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of a job.

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
