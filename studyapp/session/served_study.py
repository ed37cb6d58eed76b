"""A study as it is served: its definition and every video a participant may be shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Self

from motion.errors import InputError, listed
from motion.segment import Segment
from studyapp.session.refusal import ConflictError
from studyapp.study.design.trial import Arm, Content
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media, VideoFile
from studyapp.study.settings.reading import parse_text, read_text
from studyapp.study.settings.study import Study
from studyapp.study.versioning import design_digest


@dataclass(frozen=True, kw_only=True)
class ServedStudy:
    """A study whose media are complete.

    Attributes
    ----------
    definition : str
        The study file's text.
    videos : mapping of Content to VideoFile
        Every video that a participant may be shown.
    """

    study: Study
    definition: str
    segments: tuple[Segment, ...]
    videos: Mapping[Content, VideoFile]

    @classmethod
    def read(cls, root: Path) -> Self:
        """Read the study in folder `root`.

        Raises
        ------
        InputError
            If its definition, segments or stimuli are unusable, or a video that a participant
            may be shown is missing; the message names the file.
        """
        folder = StudyFolder(root)
        definition = read_text(folder.definition)
        study = parse_text(definition, where=folder.definition)
        segments = tuple(folder.segments_of(study))
        media = Media.of(folder, study)
        videos: dict[Content, VideoFile] = {}
        for content in study.contents(segments):
            found = media.find(content)
            if found is None:
                raise InputError(
                    f"there is no video of {describe_content(content)}",
                    where=folder.stimuli,
                    remedy="Run 'motionjury render'",
                )
            if not found.file.is_file():
                raise InputError(
                    "the video is missing",
                    where=found.file,
                    remedy="Bring it there"
                    if study.is_finished(content[0].condition)
                    else "Run 'motionjury render' again",
                )
            videos[content] = replace(found, file=found.file.resolve())
        return cls(study=study, definition=definition, segments=segments, videos=videos)

    def opened_for(self, *, rehearsal: bool) -> Self:
        """Return the study as it is opened: nobody recruits simulated participants.

        Raises
        ------
        InputError
            If a code is missing that the recruiter's participants would need.
        """
        if rehearsal:
            open_to_all = self.study.recruitment.model_copy(
                update={"channel": "link", "newcomers_per_address": 0}
            )
            study = self.study.model_copy(update={"recruitment": open_to_all})
            return replace(self, study=study)
        if missing := self.study.recruitment.missing_codes:
            raise InputError(
                f"the study has no code for {listed(missing)}",
                where="recruitment.prolific in study.toml",
                remedy="Write them there, or draw them with 'motionjury recruit STUDY codes'",
            )
        return self

    def opened_to_try(self) -> Self:
        """Return the study as it is tried: open to those who have a link, and to nobody else."""
        recruitment = self.study.recruitment.model_copy(update={"channel": "invitations"})
        changed = {"recruitment": recruitment, "open": True}
        return replace(self, study=self.study.model_copy(update=changed))

    @cached_property
    def has_sound(self) -> bool:
        """Whether any video is to be heard."""
        return any(shown.speech is not None for content in self.videos for shown in content)

    @cached_property
    def design(self) -> str:
        """Digest of what may not change while the study runs."""
        return design_digest(self.study, self.segments, self.videos)

    @cached_property
    def arms(self) -> Mapping[tuple[str, str], Arm]:
        """The study's arms, by their names and the digests of what their participants see."""
        return {
            (
                arm.name,
                design_digest(self.study.design_of(arm), self.segments, self.videos),
            ): arm
            for arm in self.study.arms
        }


class VideoRecord:
    """What the study folder says of the videos while they are served.

    Rendering may replace them at any time. Nobody is to see one that was not there when the
    study was opened.
    """

    def __init__(self, root: Path, served: ServedStudy) -> None:
        self._folder = StudyFolder(root)
        self._served = served
        self._read: tuple[int, int] | None = None
        self._changed = False

    def require_unchanged(self) -> None:
        """Make sure that every video is still the one that was opened.

        Raises
        ------
        ConflictError
            If one is made from something else now, or is being made again.
        """
        try:
            state = self._folder.stimuli.stat()
        except FileNotFoundError:
            return
        written = (state.st_ino, state.st_mtime_ns)
        if written != self._read:
            self._changed = self._differs()
            self._read = written
        if self._changed:
            raise changed_study_error()

    def _differs(self) -> bool:
        media = Media.of(self._folder, self._served.study)
        for content, video in self._served.videos.items():
            found = media.find(content)
            if found is None or found.made_from != video.made_from:
                return True
        return False


def changed_study_error() -> ConflictError:
    """Return what those are told who come while another study takes the place of this one."""
    return ConflictError(
        "The study has just been changed, and this page belongs to its earlier version.",
        "Please try again in a few minutes with the same link.",
    )


def describe_content(content: Content) -> str:
    """Return what a video shows, in words for the researcher."""
    conditions = " beside ".join(repr(stimulus.condition) for stimulus in content)
    segments = listed(list(dict.fromkeys(stimulus.segment for stimulus in content)))
    speech = content[0].speech
    other = f" with the speech of {speech}" if speech not in (None, content[0].segment) else ""
    return f"{conditions} for segment {segments}{other}"
