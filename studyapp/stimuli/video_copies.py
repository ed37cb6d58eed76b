"""Copies of videos for participants, where the original files would reveal more than they show.

Finished videos come from any tool: their files may name it, differ by some frames in length, or
contain sound that should not be heard. Copies keep the encoded picture and are alike in everything
else. Originals are never changed.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

from motion.errors import InputError
from motion.files import digest
from motion.segment import Segment
from renderer.look import COPY_VERSION
from renderer.stream_copy import copy_video, end_of
from studyapp.stimuli.media_probe import flaw_of
from studyapp.stimuli.render_record import RenderCount
from studyapp.study.design.trial import Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import (
    Stimuli,
    VideoCopy,
    finished_video_path,
    read_stimuli,
    recorded_stimuli,
    shows_copy,
    write_stimuli,
)
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class _Original:
    """A video to be copied, and the digest of its source."""

    file: Path
    made_from: str

    @property
    def key(self) -> str:
        """Digest of everything that its copies depend on."""
        return digest(COPY_VERSION, self.made_from)


def copy_videos(folder: StudyFolder) -> RenderCount:
    """Copy all videos that participants see as copies, unless a copy is up to date.

    All copies of a segment get the length of the longest, within the tolerance of `motionjury
    check`.
    """
    study = folder.study()
    segments = {segment.name: segment for segment in folder.segments_of(study)}
    before = recorded_stimuli(folder.stimuli)
    existing = frozenset(before.copies)
    made: list[VideoCopy] = []
    kept: list[VideoCopy] = []
    failures: list[str] = []
    by_segment = _originals(folder, study, tuple(segments.values()), before)
    for name, originals in by_segment.items():
        usable = {}
        for stimulus, original in originals.items():
            sound = stimulus.speech is not None
            flaw = flaw_of(original.file, segments[name].duration, sound=sound)
            if flaw is None:
                usable[stimulus] = original
                continue
            failures.append(f"{original.file.relative_to(folder.root)} {flaw.what}")
        files = {original.file for original in usable.values()}
        length = max(map(end_of, files), default=Fraction(0))
        for stimulus, original in usable.items():
            copy = VideoCopy(
                condition=stimulus.condition,
                segment=stimulus.segment,
                heard=stimulus.speech,
                file=f"videos/copies/{digest(stimulus)}.mp4",
                duration=float(length),
                key=f"{original.key}-{float(length):.6f}",
                original=original.made_from,
            )
            if copy in existing and (folder.root / copy.file).is_file():
                kept.append(copy)
                continue
            try:
                copy_video(
                    original.file,
                    folder.root / copy.file,
                    lasts=length,
                    sound=copy.heard is not None,
                )
            except InputError as error:
                failures.append(str(error))
            else:
                made.append(copy)
    current = sorted([*kept, *made], key=lambda copy: copy.file)
    if made or len(current) != len(before.copies):
        write_stimuli(folder.stimuli, before.model_copy(update={"copies": tuple(current)}))
    for file in {copy.file for copy in before.copies} - {copy.file for copy in current}:
        (folder.root / file).unlink(missing_ok=True)
    return RenderCount(made=len(made), kept=len(kept), failures=tuple(dict.fromkeys(failures)))


def out_of_date(folder: StudyFolder) -> list[VideoCopy]:
    """Return the copies whose original has changed."""
    study = folder.study()
    stimuli = read_stimuli(folder.stimuli)
    segments = folder.segments_of(study)
    current = {
        stimulus: original.key
        for originals in _originals(folder, study, segments, stimuli).values()
        for stimulus, original in originals.items()
        if original.file.is_file()
    }
    return [
        copy
        for copy in stimuli.copies
        if not copy.key.startswith(current.get(copy.stimulus, copy.key))
    ]


def _originals(
    folder: StudyFolder, study: Study, segments: Sequence[Segment], stimuli: Stimuli
) -> Mapping[str, Mapping[Stimulus, _Original]]:
    """Return the videos to copy, by segment and by the stimulus that the copy shows."""
    # A rendered clip is identified by its key, since its file is padded after copying.
    rendered = {
        clip.content: _Original(file=folder.root / clip.file, made_from=clip.key)
        for clip in stimuli.clips
    }
    originals: defaultdict[str, dict[Stimulus, _Original]] = defaultdict(dict)
    for content in study.contents(segments):
        if not shows_copy(study, content):
            continue
        (stimulus,) = content
        heard = replace(stimulus, speech=stimulus.speech or stimulus.segment)
        original = rendered.get((heard,))
        if study.is_finished(stimulus.condition):
            file = finished_video_path(folder.videos, stimulus)
            original = _Original(file=file, made_from=digest(file) if file.is_file() else "")
        if original is not None:
            originals[stimulus.segment][stimulus] = original
    return originals
