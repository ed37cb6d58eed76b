"""`stimuli.json`: every file that rendering made of a study, and what it is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import write_text
from studyapp.study.settings.validation import explain

VIDEOS: Final = "videos"
"""The folder of the videos in a study's folder."""


class _Record(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _RenderedVideo(_Record):
    """What all rendered videos have.

    Attributes
    ----------
    file : str
        Path relative to the study folder.
    duration : float
        Seconds.
    key : str
        Digest of everything the picture depends on; rendering is skipped while it stays.
    """

    segment: str
    file: str
    duration: float
    key: str


class ClipVideo(_RenderedVideo):
    """One rendered motion clip.

    Attributes
    ----------
    speech : str or None
        The segment that is heard with it where that is another one than its own.
    """

    condition: str
    speech: str | None = None


class PairVideo(_RenderedVideo):
    """One composed pair, `left` under the label A and `right` under B.

    Its file name says nothing of the conditions.
    """

    left: str
    right: str


class VideoCopy(_RenderedVideo):
    """What participants are shown of a finished video, or of a clip without its sound.

    Its picture is encoded as in the original; its name says nothing of the condition.

    Attributes
    ----------
    heard : str or None
        The segment whose speech is heard; None for no sound at all.
    original : str
        Digest of the finished video, or the key of the clip, that it is a copy of.
    """

    condition: str
    heard: str | None
    original: str


class Stimuli(_Record):
    """All media of a study that were made by `motionjury render`."""

    format: Literal[1] = 1
    clips: tuple[ClipVideo, ...] = ()
    pairs: tuple[PairVideo, ...] = ()
    copies: tuple[VideoCopy, ...] = ()

    def pair(self, segment: str, left: str, right: str) -> PairVideo | None:
        """Return the pair video of `segment` with these sides, or None."""
        for pair in self.pairs:
            if (pair.segment, pair.left, pair.right) == (segment, left, right):
                return pair
        return None


def read_stimuli(path: Path) -> Stimuli:
    """Read `stimuli.json`.

    Raises
    ------
    InputError
        If it is missing or damaged, or names a file outside the study's folder. The folder of the
        videos may be a link to another disk.
    """
    try:
        stimuli = Stimuli.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        raise InputError(
            "the study has no videos yet", where=path, remedy="Run 'motionjury render' first"
        ) from None
    except ValidationError as error:
        raise InputError(
            explain(error), where=path, remedy="Delete it and run 'motionjury render' again"
        ) from None
    inside = (path.parent.resolve(), (path.parent / VIDEOS).resolve())
    for video in (*stimuli.clips, *stimuli.pairs, *stimuli.copies):
        if not _lies_in(inside, path.parent, video.file):
            raise InputError(
                f"the video {video.file!r} lies outside the study's folder",
                where=path,
                remedy="Copy it into the folder 'videos' and name it there, or delete this file "
                "and run 'motionjury render' again",
            )
    return stimuli


def _lies_in(folders: Sequence[Path], root: Path, file: str) -> bool:
    """Tell whether `file`, as `root` names it, leads into one of `folders`, links followed."""
    if "\0" in file:
        return False
    place = (root / file).resolve()
    return any(place.is_relative_to(folder) for folder in folders)


def write_stimuli(path: Path, stimuli: Stimuli) -> None:
    """Write `stimuli.json` in one step, so that no reader sees half of it."""
    write_text(path, stimuli.model_dump_json(indent=1) + "\n")
