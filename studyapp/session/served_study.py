"""A served study: its definition, segments and videos."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from motion.errors import InputError, listed
from motion.segment import Segment
from studyapp.session.refusal import ConflictError
from studyapp.study.design.trial import Arm, Content, has_sound
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
        Every video that a participant may see.
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
            If its definition, segments or stimuli are unusable, or a video is missing.
        """
        folder = StudyFolder(root)
        definition = read_text(folder.definition)
        study = parse_text(definition, where=folder.definition)
        segments = folder.segments_of(study)
        media = Media.of(folder, study)
        videos: dict[Content, VideoFile] = {}
        for content in study.contents(segments):
            video = media.find(content)
            if video is None:
                raise InputError(
                    f"there is no video of {describe_content(content)}",
                    where=folder.stimuli,
                    remedy="Run 'motionjury render'",
                )
            if not video.file.is_file():
                raise InputError(
                    "the video is missing",
                    where=video.file,
                    remedy="Put it there"
                    if study.is_finished(content[0].condition)
                    else "Run 'motionjury render' again",
                )
            videos[content] = replace(video, file=video.file.resolve())
        return cls(study=study, definition=definition, segments=segments, videos=videos)

    def opened_for(self, *, rehearsal: bool) -> Self:
        """Return the study for real participants, or open to everybody for a rehearsal.

        Raises
        ------
        InputError
            If the recruiter's completion codes are missing.
        """
        if rehearsal:
            return self._recruiting({"channel": "link", "newcomers_per_address": 0})
        if missing := self.study.recruitment.missing_codes:
            raise InputError(
                f"the study has no code for {listed(missing)}",
                where="recruitment.prolific in study.toml",
                remedy="Write them there, or draw them with 'motionjury recruit STUDY codes'",
            )
        return self

    def opened_to_try(self) -> Self:
        """Return the study for a tryout: open to people with an invitation only."""
        return self._recruiting({"channel": "invitations"}, open=True)

    def _recruiting(self, recruitment: Mapping[str, Any], **keys: Any) -> Self:
        section = self.study.recruitment.model_copy(update=recruitment)
        return replace(self, study=self.study.model_copy(update={"recruitment": section, **keys}))

    @cached_property
    def has_sound(self) -> bool:
        """Whether any video has sound."""
        return has_sound(self.videos)

    @cached_property
    def design(self) -> str:
        """Digest of the design, which may not change while the study runs."""
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
    """Notices when rendering replaces videos that are being served.

    Nobody may see a video that was not there when the study was opened.
    """

    def __init__(self, root: Path, served: ServedStudy) -> None:
        self._folder = StudyFolder(root)
        self._served = served
        self._read: tuple[int, int] | None = None
        self._changed = False

    def require_unchanged(self) -> None:
        """Raise `ConflictError` if a video has been replaced since the study was opened."""
        try:
            state = self._folder.stimuli.stat()
        except FileNotFoundError:
            return
        written = (state.st_ino, state.st_mtime_ns)
        if written != self._read:
            self._changed = self._has_other_videos()
            self._read = written
        if self._changed:
            raise changed_study_error()

    def _has_other_videos(self) -> bool:
        media = Media.of(self._folder, self._served.study)
        for content, video in self._served.videos.items():
            present = media.find(content)
            if present is None or present.made_from != video.made_from:
                return True
        return False


def changed_study_error() -> ConflictError:
    """Return the refusal of those who come while this study is being replaced."""
    return ConflictError(
        "The study has just been changed, and this page belongs to its earlier version.",
        "Please try again in a few minutes with the same link.",
    )


def describe_content(content: Content) -> str:
    """Describe what a video shows, for the researcher."""
    conditions = " beside ".join(repr(stimulus.condition) for stimulus in content)
    segments = listed(list(dict.fromkeys(stimulus.segment for stimulus in content)))
    speech = content[0].speech
    is_mismatched = speech not in (None, content[0].segment)
    mismatched = f" with the speech of {speech}" if is_mismatched else ""
    return f"{conditions} for segment {segments}{mismatched}"
