"""Copies of videos for participants, where the files themselves would tell more than they show.

Finished videos come from any tool: their files name it, may last some frames more or less, and
carry sound where none is to be heard. Copies have the same picture, encoded as it was, and are
alike in all else. Originals are never changed.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from motion.errors import InputError
from motion.files import digest
from motion.segment import Segment
from renderer.look import COPY_VERSION
from renderer.stream_copy import copy_video, end_of
from studyapp.stimuli.media_probe import flaw_of
from studyapp.study.design.trial import Stimulus
from studyapp.study.finished_videos import finished_video_path, shows_copy, similar_file
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Stimuli, VideoCopy, read_stimuli, stimulus_of_copy, write_stimuli
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class CopyCount:
    """What a run copied.

    Attributes
    ----------
    made, kept : int
        Copies made by this run, and those that were there and still fit.
    failures : tuple of str
        Videos that could not be copied, and why.
    """

    made: int = 0
    kept: int = 0
    failures: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class _Original:
    """A video to be copied, and what tells it from every other."""

    file: Path
    made_from: str

    @property
    def key(self) -> str:
        """What its copies depend on, the way of copying included."""
        return digest(COPY_VERSION, self.made_from)


def copy_videos(folder: StudyFolder) -> CopyCount:
    """Copy each video that participants are shown a copy of, unless it was and still fits.

    All copies of one segment last equally long: as long as the longest of them, within the
    tolerance that `motionjury check` allows.
    """
    study = folder.study()
    segments = {segment.name: segment for segment in folder.segments_of(study)}
    before = read_stimuli(folder.stimuli) if folder.stimuli.exists() else Stimuli()
    known = frozenset(before.copies)
    made: list[VideoCopy] = []
    kept: list[VideoCopy] = []
    failures: list[str] = []
    by_segment = _originals(folder, study, tuple(segments.values()), before)
    needed = {original.file for each in by_segment.values() for original in each.values()}
    for name, originals in by_segment.items():
        usable = {}
        for stimulus, original in originals.items():
            flaw = _flaw_of(original.file, segments[name], sound=stimulus.speech is not None)
            if flaw is None:
                usable[stimulus] = original
                continue
            similar = None if original.file.is_file() else similar_file(original.file, needed)
            meant = "" if similar is None else f" (is it {similar.relative_to(folder.root)}?)"
            failures.append(f"{original.file.relative_to(folder.root)} {flaw}{meant}")
        files = {original.file for original in usable.values()}
        lasts = max(map(end_of, files), default=Fraction(0))
        for stimulus, original in usable.items():
            copy = _copy_of(stimulus, original, lasts)
            if copy in known and (folder.root / copy.file).is_file():
                kept.append(copy)
                continue
            try:
                copy_video(
                    original.file,
                    folder.root / copy.file,
                    lasts=lasts,
                    sound=copy.heard is not None,
                )
            except InputError as error:
                failures.append(str(error))
            else:
                made.append(copy)
    current = sorted([*kept, *made], key=lambda copy: copy.file)
    if made or len(current) != len(before.copies):
        write_stimuli(folder.stimuli, before.model_copy(update={"copies": tuple(current)}))
    for gone in {copy.file for copy in before.copies} - {copy.file for copy in current}:
        (folder.root / gone).unlink(missing_ok=True)
    return CopyCount(made=len(made), kept=len(kept), failures=tuple(dict.fromkeys(failures)))


def out_of_date(folder: StudyFolder) -> list[VideoCopy]:
    """Return the copies whose original has changed since."""
    study = folder.study()
    stimuli = read_stimuli(folder.stimuli)
    segments = tuple(folder.segments_of(study))
    current = {
        stimulus: original.key
        for originals in _originals(folder, study, segments, stimuli).values()
        for stimulus, original in originals.items()
        if original.file.is_file()
    }
    return [
        copy
        for copy in stimuli.copies
        if not copy.key.startswith(current.get(stimulus_of_copy(copy), copy.key))
    ]


def _originals(
    folder: StudyFolder, study: Study, segments: Sequence[Segment], stimuli: Stimuli
) -> Mapping[str, Mapping[Stimulus, _Original]]:
    """Return, for each segment, the videos to be copied and what each copy shows."""
    # A rendered clip is told by its key: its file is padded after it was copied.
    rendered = {
        (clip.condition, clip.segment, clip.speech or clip.segment): _Original(
            file=folder.root / clip.file, made_from=clip.key
        )
        for clip in stimuli.clips
    }
    originals: defaultdict[str, dict[Stimulus, _Original]] = defaultdict(dict)
    for content in study.contents(segments):
        if not shows_copy(study, content):
            continue
        (shown,) = content
        made = rendered.get((shown.condition, shown.segment, shown.speech or shown.segment))
        if study.is_finished(shown.condition):
            file = finished_video_path(folder.videos, shown)
            made = _Original(file=file, made_from=digest(file) if file.is_file() else "")
        if made is not None:
            originals[shown.segment][shown] = made
    return originals


def _flaw_of(file: Path, segment: Segment, *, sound: bool) -> str | None:
    """Return why participants cannot be shown a copy of `file`; None where they can."""
    if not file.is_file():
        return "is missing"
    flaw = flaw_of(file, segment.duration, sound=sound)
    return None if flaw is None else flaw.what


def _copy_of(stimulus: Stimulus, original: _Original, lasts: Fraction) -> VideoCopy:
    return VideoCopy(
        condition=stimulus.condition,
        segment=stimulus.segment,
        heard=stimulus.speech,
        file=f"videos/copies/{digest(stimulus)}.mp4",
        duration=float(lasts),
        key=f"{original.key}-{float(lasts):.6f}",
        original=original.made_from,
    )
