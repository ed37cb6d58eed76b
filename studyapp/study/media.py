"""`stimuli.json`, all that rendering made of a study, and which file shows participants what."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import digest, write_text
from studyapp.study.design.trial import Content, Stimulus
from studyapp.study.finished_videos import finished_video_path, shows_copy
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.sections import explain_errors
from studyapp.study.settings.study import Study

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
            explain_errors(error), where=path, remedy="Delete it and run 'motionjury render' again"
        ) from None
    inside = (path.parent.resolve(), (path.parent / VIDEOS).resolve())
    for video in (*stimuli.clips, *stimuli.pairs, *stimuli.copies):
        if not _is_within(inside, path.parent, video.file):
            raise InputError(
                f"the video {video.file!r} lies outside the study's folder",
                where=path,
                remedy="Copy it into the folder 'videos' and name it there, or delete this file "
                "and run 'motionjury render' again",
            )
    return stimuli


def _is_within(folders: Sequence[Path], root: Path, file: str) -> bool:
    """Tell whether `file`, as `root` names it, leads into one of `folders`, links followed."""
    if "\0" in file:
        return False
    place = (root / file).resolve()
    return any(place.is_relative_to(folder) for folder in folders)


def write_stimuli(path: Path, stimuli: Stimuli) -> None:
    """Write `stimuli.json` in one step, so that no reader sees half of it."""
    write_text(path, stimuli.model_dump_json(indent=1) + "\n")


@dataclass(frozen=True, kw_only=True)
class VideoFile:
    """A video's file.

    Attributes
    ----------
    duration : float
        Seconds.
    made_from : str
        Digest of all that its picture and sound depend on. It stays where the file is made again
        from the same, or is only padded or copied anew.
    """

    file: Path
    duration: float
    made_from: str


@dataclass(frozen=True, kw_only=True)
class Media:
    """All videos that a study's participants are shown.

    Attributes
    ----------
    study : Study
        Tells of which videos copies are shown.
    rendered : mapping of Content to VideoFile
        What `motionjury render` has rendered.
    copies : mapping of Content to VideoFile
        What it has copied.
    """

    study: Study
    rendered: Mapping[Content, VideoFile]
    copies: Mapping[Content, VideoFile]

    @classmethod
    def of(cls, folder: StudyFolder, study: Study) -> Self:
        """Read what the study in `folder` has.

        Raises
        ------
        InputError
            If nothing was rendered yet.
        """
        stimuli = read_stimuli(folder.stimuli)
        return cls(
            study=study,
            rendered=_rendered_videos(folder, stimuli),
            copies={
                (stimulus_of_copy(copy),): VideoFile(
                    file=folder.root / copy.file, duration=copy.duration, made_from=copy.original
                )
                for copy in stimuli.copies
            },
        )

    def find(self, content: Content) -> VideoFile | None:
        """Return the video that shows `content`, whether or not its file is there; else None."""
        made = self.copies if shows_copy(self.study, content) else self.rendered
        return made.get(content)


def stimulus_of_copy(copy: VideoCopy) -> Stimulus:
    """Return what a copy shows."""
    return Stimulus(condition=copy.condition, segment=copy.segment, speech=copy.heard)


def _rendered_videos(folder: StudyFolder, stimuli: Stimuli) -> dict[Content, VideoFile]:
    clips: dict[Content, VideoFile] = {
        (
            Stimulus(
                condition=clip.condition,
                segment=clip.segment,
                speech=clip.speech or clip.segment,
            ),
        ): VideoFile(file=folder.root / clip.file, duration=clip.duration, made_from=clip.key)
        for clip in stimuli.clips
    }
    pairs: dict[Content, VideoFile] = {
        tuple(Stimulus.own(side, pair.segment) for side in (pair.left, pair.right)): VideoFile(
            file=folder.root / pair.file, duration=pair.duration, made_from=pair.key
        )
        for pair in stimuli.pairs
    }
    return clips | pairs


@dataclass(frozen=True)
class StimulusVideo:
    """A video, rendered or brought.

    Attributes
    ----------
    file : Path
        Where it is.
    rendered : str
        Digest of everything that a rendered one depends on; empty for one that was brought.
    """

    file: Path
    rendered: str = ""

    @property
    def key(self) -> str:
        """What tells it from every other video."""
        return self.rendered or digest(self.file)


def stimulus_videos(
    folder: StudyFolder, study: Study, shown: Iterable[tuple[str, str]]
) -> dict[tuple[str, str], StimulusVideo]:
    """Return the videos that are there of each (segment, condition), with its own speech."""
    rendered = () if study.only_finished else read_stimuli(folder.stimuli).clips
    videos = {
        (clip.segment, clip.condition): StimulusVideo(folder.root / clip.file, clip.key)
        for clip in rendered
        if clip.speech is None
    }
    for segment, condition in shown:
        if study.is_finished(condition):
            file = finished_video_path(folder.videos, Stimulus.own(condition, segment))
            if file.is_file():
                videos[segment, condition] = StimulusVideo(file)
    return {key: video for key, video in videos.items() if video.file.is_file()}
