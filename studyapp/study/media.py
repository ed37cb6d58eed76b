"""`stimuli.json`, the record of all rendered videos, and the video of each content.

Participants see copies of finished videos from other tools, so the original files stay untouched.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import digest, write_text
from motion.segment import SEGMENTS_FILE, write_segments
from studyapp.study.design.trial import Content, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.sections import explain_errors
from studyapp.study.settings.study import Study


class _Record(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _RenderedVideo(_Record):
    """What all rendered videos share.

    Attributes
    ----------
    file : str
        Path relative to the study folder.
    duration : float
        Seconds.
    key : str
        Digest of everything the picture depends on; while it stays, nothing is rendered again.
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
        The segment heard with it; None for its own.
    """

    condition: str
    speech: str | None = None

    @property
    def content(self) -> Content:
        """What it shows."""
        speech = self.speech or self.segment
        return (Stimulus(condition=self.condition, segment=self.segment, speech=speech),)


class PairVideo(_RenderedVideo):
    """Two motions in one video, `left` labelled A and `right` B.

    Its file name does not reveal the conditions.
    """

    left: str
    right: str

    @property
    def content(self) -> Content:
        """What it shows."""
        return (Stimulus.own(self.left, self.segment), Stimulus.own(self.right, self.segment))


class VideoCopy(_RenderedVideo):
    """A copy for participants of a finished video, or of a clip without its sound.

    The picture stream is that of the original; the file name does not reveal the condition.

    Attributes
    ----------
    heard : str or None
        The segment whose speech is heard; None for silence.
    original : str
        Digest of the finished video, or key of the clip.
    """

    condition: str
    heard: str | None
    original: str

    @property
    def stimulus(self) -> Stimulus:
        """What it shows."""
        return Stimulus(condition=self.condition, segment=self.segment, speech=self.heard)


class Stimuli(_Record):
    """All videos that `motionjury render` has made."""

    format: Literal[1] = 1
    clips: tuple[ClipVideo, ...] = ()
    pairs: tuple[PairVideo, ...] = ()
    copies: tuple[VideoCopy, ...] = ()


def read_stimuli(path: Path) -> Stimuli:
    """Read `stimuli.json`.

    Raises
    ------
    InputError
        If it is missing or damaged, or names a file outside the study folder. The folder of
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
    folders = (path.parent.resolve(), (path.parent / "videos").resolve())
    for video in (*stimuli.clips, *stimuli.pairs, *stimuli.copies):
        if "\0" in video.file or not any(
            (path.parent / video.file).resolve().is_relative_to(folder) for folder in folders
        ):
            raise InputError(
                f"the video {video.file!r} lies outside the study's folder",
                where=path,
                remedy="Copy it into the folder 'videos' and name it there, or delete this file "
                "and run 'motionjury render' again",
            )
    return stimuli


def recorded_stimuli(path: Path) -> Stimuli:
    """Read `stimuli.json`; before it exists, nothing is recorded."""
    return read_stimuli(path) if path.exists() else Stimuli()


def write_stimuli(path: Path, stimuli: Stimuli) -> None:
    """Write `stimuli.json`."""
    write_text(path, stimuli.model_dump_json(indent=1) + "\n")


def remove_segment_files(folder: StudyFolder, name: str) -> None:
    """Remove one of several segments, with its motion, its videos, and speech that only it uses.

    Videos with its speech and another segment's motion are removed too.
    """
    stimuli = recorded_stimuli(folder.stimuli)
    files = [
        *(clip.file for clip in stimuli.clips if name in (clip.segment, clip.speech)),
        *(pair.file for pair in stimuli.pairs if name == pair.segment),
        *(copy.file for copy in stimuli.copies if name in (copy.segment, copy.heard)),
    ]
    finished = (f"videos/*/{each}.mp4" for each in (name, f"{name}@*", f"*@{name}"))
    for pattern in (*files, *finished, f"motion/*/{name}.npz"):
        for path in folder.root.glob(pattern):
            path.unlink()
    # Now, so that an interrupted removal can be repeated.
    if (folder.speech / SEGMENTS_FILE).exists():
        kept = {segment.name: segment for segment in folder.segments()}
        wav = kept.pop(name).wav
        write_segments(folder.speech, kept.values())
        folder.semantics(name).unlink(missing_ok=True)
        if all(segment.wav != wav for segment in kept.values()):
            (folder.speech / wav).unlink()


def finished_video_path(videos: Path, stimulus: Stimulus) -> Path:
    """Return the path of the finished video of `stimulus` in the folder `videos`.

    It is ``<condition>/<segment>.mp4``, or ``<condition>/<segment>@<speech>.mp4`` with another
    segment's speech; segment names contain no @. A stimulus without sound is copied from the video
    with its own speech.
    """
    is_mismatched = stimulus.speech not in (None, stimulus.segment)
    name = f"{stimulus.segment}@{stimulus.speech}" if is_mismatched else stimulus.segment
    return videos / stimulus.condition / f"{name}.mp4"


def shows_copy(study: Study, content: Content) -> bool:
    """Tell whether participants see a copy of the video of `content`.

    They do for every video without sound, and for every single video of a study that has finished
    ones: their files would give the condition away.
    """
    (first, *others) = content
    finished = any(map(study.is_finished, (*study.conditions, study.catch.condition)))
    return not others and (finished or first.speech is None)


@dataclass(frozen=True, kw_only=True)
class VideoFile:
    """A video's file.

    Attributes
    ----------
    duration : float
        Seconds.
    made_from : str
        Digest of everything its picture and sound depend on. Rendering, padding or copying it
        again from the same does not change it.
    """

    file: Path
    duration: float
    made_from: str


@dataclass(frozen=True, kw_only=True)
class Media:
    """All videos that participants of `study` may see, rendered and copied."""

    study: Study
    rendered: Mapping[Content, VideoFile]
    copies: Mapping[Content, VideoFile]

    @classmethod
    def of(cls, folder: StudyFolder, study: Study) -> Self:
        """Read the videos in `folder`; `InputError` if nothing has been rendered yet."""
        stimuli = read_stimuli(folder.stimuli)

        def file(video: _RenderedVideo, made_from: str) -> VideoFile:
            path = folder.root / video.file
            return VideoFile(file=path, duration=video.duration, made_from=made_from)

        rendered: tuple[ClipVideo | PairVideo, ...] = (*stimuli.clips, *stimuli.pairs)
        return cls(
            study=study,
            rendered={video.content: file(video, video.key) for video in rendered},
            copies={(copy.stimulus,): file(copy, copy.original) for copy in stimuli.copies},
        )

    def find(self, content: Content) -> VideoFile | None:
        """Return the recorded video of `content`, whether or not its file exists; else None."""
        videos = self.copies if shows_copy(self.study, content) else self.rendered
        return videos.get(content)


@dataclass(frozen=True)
class StimulusVideo:
    """A rendered or finished video.

    Attributes
    ----------
    file : Path
    rendered : str
        The key of a rendered one; empty for a finished one.
    """

    file: Path
    rendered: str = ""

    @property
    def key(self) -> str:
        """Tells it from every other video."""
        return self.rendered or digest(self.file)


def stimulus_videos(
    folder: StudyFolder, study: Study, shown: Iterable[tuple[str, str]]
) -> dict[tuple[str, str], StimulusVideo]:
    """Return the existing videos of each (segment, condition) with its own speech."""
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
