"""Bringing recorded or generated motion into a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio, read_audio, write_wav
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import write_clip
from motion.formats.beat_tracks import write_semantic_scores
from motion.formats.joint_maps import JointMap
from motion.placement import place
from motion.resample import cut
from motion.segment import Segment, check_name
from studyapp.stimuli.recorded_beside import (
    read_recorded,
    semantics_beside,
    with_words_beside,
)
from studyapp.stimuli.shown_motion import SEGMENT_TOLERANCE, check_same_length, licensed_hands
from studyapp.stimuli.stored_speech import (
    check_no_clash,
    check_same_speech,
    known_segments,
    store_segments,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study
from studyapp.study.study_file import add_condition

TAKE_TOLERANCE: Final = 1.0
"""Seconds by which the ends of a take's motion and speech may differ; it is cut to the shorter."""


@dataclass(frozen=True, kw_only=True)
class RecordingFacts:
    """What files of recordings do not say themselves.

    Attributes
    ----------
    condition : str or None
        What their motion belongs to.
    speaker, emotion : str or None
        What their segments are.
    segment_seconds : float or None
        Length of the segments that each is cut into; None keeps it whole.
    frame_rate : float or None
        Overrides what motion files say of their frame rate.
    as_recorded : bool
        Whether hands of a BVH stay where they come to lie inside the body.
    joint_map : mapping of str to str, optional
        For a BVH of an unknown skeleton, see `motion.formats.read_motion`.
    """

    condition: str | None = None
    speaker: str | None = None
    emotion: str | None = None
    segment_seconds: float | None = None
    frame_rate: float | None = None
    as_recorded: bool = False
    joint_map: JointMap | None = None


@dataclass(frozen=True, kw_only=True)
class Take(RecordingFacts):
    """A recording of speech, mostly with motion, and what to make of it.

    Attributes
    ----------
    motion : Path or None
        In any format the project reads; None of speech alone.
    speech : Path
        In any format the project reads.
    """

    motion: Path | None
    speech: Path
    speaker: str
    emotion: str


def import_take(folder: StudyFolder, take: Take) -> tuple[list[Segment], list[str]]:
    """Cut a take into segments, and store their speech and motion in the study.

    Nothing is written before everything has been read and checked.

    Returns
    -------
    segments : list of Segment
        The segments that the take gave.
    notes : list of str
        What was changed on the way, for the researcher to read.

    Raises
    ------
    InputError
        If a file cannot be used, the two do not belong together, the condition's motion is
        generated or another one, or a segment of the same name but another place or other speech
        exists.
    """
    study = folder.study()
    if take.condition is not None:
        _check_condition(study, take.condition, folder)
    check_name(take.speech.stem, "segment", take.speech)
    audio = read_audio(take.speech, sample_rate=None)
    clip, seconds, motion_notes = _motion_of(folder, study, take, audio)
    notes = [*audio.notes, *motion_notes]
    segments = _cut_points(take, seconds)
    rest = seconds - segments[-1].end
    if rest > SEGMENT_TOLERANCE:
        notes.append(
            f"{take.speech.name}: the last {rest:.1f} s make no whole segment and are left out"
        )
    named = take.motion or take.speech
    segments, word_notes = with_words_beside(segments, named, audio)
    semantics, semantic_notes = semantics_beside(segments, named)
    notes += [*word_notes, *semantic_notes]
    known = known_segments(folder)
    check_no_clash(known, segments, folder)
    check_same_speech(folder.speech / segments[0].wav, audio)
    clips = {}
    if clip is not None and take.condition is not None:
        clips = {one.name: _placed_cut(clip, one.start, one.end) for one in segments}
        _check_no_other_motion(folder, take.condition, clips)

    write_wav(folder.speech / segments[0].wav, replace(audio, notes=()))
    for name, piece in clips.items():
        write_clip(folder.clip(str(take.condition), name), piece)
    for name, spans in semantics.items():
        write_semantic_scores(folder.semantics(name), spans)
    segments = store_segments(folder, known, segments)
    if take.condition is not None:
        notes += _add_if_new(folder, study, take.condition)
    return segments, notes


def import_clips(
    folder: StudyFolder, motions: Sequence[Path], condition: str, facts: RecordingFacts
) -> list[str]:
    """Store motion made elsewhere for segments the study already has.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    motions : sequence of Path
        Motion files, each named after its segment.
    condition : str
        The condition they belong to; added to the study file where it is new.
    facts : RecordingFacts
        How they are to be read.

    Returns
    -------
    list of str
        What was changed on the way.

    Raises
    ------
    InputError
        If a file belongs to no segment, two belong to the same, one is more than 0.1 s longer or
        shorter than its speech, or the condition's motion is generated or another one.
    """
    study = folder.study()
    _check_condition(study, condition, folder)
    segments = {segment.name: segment for segment in folder.segments()}
    mean_hands = licensed_hands(folder, study)
    clips, notes = {}, []
    for path in motions:
        segment = segments.get(path.stem)
        if segment is None:
            raise InputError(
                f"no segment is called {path.stem!r}",
                where=path,
                remedy="Name the file after its segment ("
                + ", ".join(list(segments)[:3])
                + ", …), or bring its recording along, as a new take (--speech)",
            )
        if segment.name in clips:
            raise InputError(
                f"two of the files are called {path.stem!r}",
                where=path,
                remedy="Give one motion for each segment",
            )
        clip, motion_notes = _read(path, facts, mean_hands)
        check_same_length(clip, segment, path)
        notes += motion_notes
        clips[segment.name] = _placed_cut(clip, 0.0, min(clip.duration, segment.duration))
    _check_no_other_motion(folder, condition, clips)
    for name, clip in clips.items():
        write_clip(folder.clip(condition, name), clip)
    return notes + _add_if_new(folder, study, condition)


def _motion_of(
    folder: StudyFolder, study: Study, take: Take, audio: Audio
) -> tuple[MotionClip | None, float, list[str]]:
    """Return a take's motion, how many seconds can be used, and notes; None of speech alone."""
    if take.motion is None:
        return None, audio.duration, []
    clip, notes = _read(take.motion, take, licensed_hands(folder, study))
    seconds, note = _common_length(take.motion, audio, clip)
    return clip, seconds, [*notes, *note]


def _read(
    path: Path, facts: RecordingFacts, mean_hands: NDArray[np.float32] | None
) -> tuple[MotionClip, list[str]]:
    return read_recorded(
        path,
        frame_rate=facts.frame_rate,
        joint_map=facts.joint_map,
        mean_hands=mean_hands,
        as_recorded=facts.as_recorded,
    )


def _placed_cut(clip: MotionClip, start: float, end: float) -> MotionClip:
    """Return an excerpt that is placed by its own frames, whatever it was cut from.

    A segment would otherwise show whether its condition came as whole takes or as segments.
    """
    return place(cut(clip, start, end))[0]


def _common_length(motion: Path, audio: Audio, clip: MotionClip) -> tuple[float, list[str]]:
    """Return how many seconds of a take have both motion and speech."""
    difference = abs(audio.duration - clip.duration)
    lengths = f"the motion lasts {clip.duration:.2f} s, the speech {audio.duration:.2f} s"
    if difference > TAKE_TOLERANCE:
        raise InputError(
            lengths,
            where=motion,
            remedy=f"A take's ends may differ by {TAKE_TOLERANCE} s: check that the files belong "
            "together and that the frame rate is right (--fps)",
        )
    seconds = min(audio.duration, clip.duration)
    if difference <= 1e-3:
        return seconds, []
    return seconds, [f"{motion.name}: {lengths}; cut to the common {seconds:.2f} s"]


def _cut_points(take: Take, seconds: float) -> list[Segment]:
    """Return the segments of a take whose first `seconds` can be used."""
    length = take.segment_seconds if take.segment_seconds is not None else seconds
    if not length <= seconds + 1e-6:
        raise InputError(
            f"the take has {seconds:.1f} s, too short for a segment of {length:g} s",
            where=take.motion or take.speech,
            remedy="Choose a shorter length of segments (--segment)",
        )
    count = int(seconds / length + 1e-6)
    stem = take.speech.stem
    names = [f"{stem}_{n + 1:02d}" for n in range(count)] if take.segment_seconds else [stem]
    return [
        Segment(
            name=name,
            wav=f"{stem}.wav",
            start=round(n * length, 6),
            end=round((n + 1) * length, 6),
            speaker=take.speaker,
            emotion=take.emotion,
        )
        for n, name in enumerate(names)
    ]


def _check_condition(study: Study, condition: str, folder: StudyFolder) -> None:
    """Raise if motion files cannot be brought in for `condition`."""
    check_name(condition, "condition")
    generated = study.generated().get(condition)
    if generated is not None:
        raise InputError(
            f"the motion of {condition!r} is made by the generator {generated.generator!r}",
            where=folder.definition,
            remedy="Bring the files in under another condition, or remove the generator of this "
            "one first",
        )
    if condition in (*study.conditions, study.catch.condition) and study.is_finished(condition):
        raise InputError(
            f"condition {condition!r} has finished videos, no motion",
            where=folder.definition,
            remedy="Bring the files in under another condition, or remove videos = true from "
            "this one first",
        )


def _add_if_new(folder: StudyFolder, study: Study, condition: str) -> list[str]:
    """Add `condition` to the study file if it is not there yet, and say so."""
    if condition in (*study.conditions, study.catch.condition):
        return []
    add_condition(folder.definition, condition)
    return [f"{folder.definition.name}: condition {condition!r} added"]


def _check_no_other_motion(
    folder: StudyFolder, condition: str, clips: Mapping[str, MotionClip]
) -> None:
    """Raise if `condition` has another motion for a segment; the same one may come again."""
    with TemporaryDirectory() as scratch:
        draft = Path(scratch) / "clip.npz"
        for name, clip in clips.items():
            stored = folder.clip(condition, name)
            if not stored.exists():
                continue
            write_clip(draft, clip)
            if draft.read_bytes() != stored.read_bytes():
                raise InputError(
                    f"condition {condition!r} has another motion for segment {name} already",
                    where=stored,
                    remedy="Bring this one in under another condition, or remove that file first",
                )
