"""Importing speech and motion into a study."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from motion.arrays import Floats32
from motion.audio import Audio, read_audio, write_wav
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_recorded, write_clip
from motion.formats.beat_tracks import write_semantic_scores
from motion.formats.joint_maps import JointMap
from motion.placement import place
from motion.resample import cut
from motion.segment import Segment, check_name
from studyapp.stimuli.shown_motion import SEGMENT_TOLERANCE, check_same_length, licensed_hands
from studyapp.stimuli.stored_speech import (
    add_transcripts,
    cut_semantics,
    existing_segments,
    require_same_speech,
    require_same_times,
    store_segments,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study
from studyapp.study.study_file import add_condition

TAKE_TOLERANCE: Final = 1.0
"""Seconds by which a take's motion and speech may differ in length; the longer one is cut."""


@dataclass(frozen=True, kw_only=True)
class RecordingFacts:
    """What files of recordings do not state themselves.

    Attributes
    ----------
    condition : str or None
        The condition of the motion.
    speaker, emotion : str or None
        Speaker and emotion of the segments.
    segment_seconds : float or None
        Length of segments; None keeps a take in one piece.
    frame_rate : float or None
        Overrides the frame rate of motion files.
    as_recorded : bool
        Keep the hands of a BVH where they are, even inside the body.
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
    """A take to import.

    Attributes
    ----------
    motion : Path or None
        The motion file; None for speech alone.
    speech : Path
        The recording.
    """

    motion: Path | None
    speech: Path
    speaker: str
    emotion: str


def import_take(folder: StudyFolder, take: Take) -> tuple[list[Segment], list[str]]:
    """Cut a take into segments, and store their speech and motion in the study.

    Nothing is written before everything was read and checked.

    Returns
    -------
    segments : list of Segment
        The segments of the take.
    notes : list of str
        Changes made while reading, for the researcher.

    Raises
    ------
    InputError
        If a file cannot be used, motion and speech do not belong together, the condition is
        generated or has other motion, or a segment of the same name exists with other times or
        other speech.
    """
    study = folder.study()
    if take.condition is not None:
        _require_imported(study, take.condition, folder)
    check_name(take.speech.stem, "segment", take.speech)
    audio = read_audio(take.speech, sample_rate=None)
    clip, seconds, motion_notes = _take_motion(folder, study, take, audio)
    notes = [*audio.notes, *motion_notes]
    segments = _make_segments(take, seconds)
    remainder = seconds - segments[-1].end
    if remainder > SEGMENT_TOLERANCE:
        notes.append(
            f"{take.speech.name}: the last {remainder:.1f} s, shorter than a segment, are left out"
        )
    named = take.motion or take.speech
    segments, transcript_notes = add_transcripts(segments, named, audio)
    semantics, semantic_notes = cut_semantics(segments, named)
    notes += [*transcript_notes, *semantic_notes]
    existing = existing_segments(folder)
    require_same_times(existing, segments, folder)
    require_same_speech(folder.speech / segments[0].wav, audio)
    clips = {}
    if clip is not None and take.condition is not None:
        clips = {item.name: _cut_and_place(clip, item.start, item.end) for item in segments}
        _require_same_motion(folder, take.condition, clips)

    write_wav(folder.speech / segments[0].wav, replace(audio, notes=()))
    for name, excerpt in clips.items():
        write_clip(folder.clip(str(take.condition), name), excerpt)
    for name, spans in semantics.items():
        write_semantic_scores(folder.semantics(name), spans)
    segments = store_segments(folder, existing, segments)
    if take.condition is not None:
        notes += add_new_condition(folder, study, take.condition)
    return segments, notes


def import_clips(
    folder: StudyFolder, motions: Sequence[Path], condition: str, facts: RecordingFacts
) -> list[str]:
    """Store motion files for existing segments.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    motions : sequence of Path
        Motion files, each named after its segment.
    condition : str
        Their condition, which is added to the study file if it is new.
    facts : RecordingFacts
        How to read them.

    Returns
    -------
    list of str
        Changes made while reading.

    Raises
    ------
    InputError
        If a file has no segment, two have the same, one differs from its speech by more than
        0.1 s, or the condition is generated or has other motion.
    """
    study = folder.study()
    _require_imported(study, condition, folder)
    segments = {segment.name: segment for segment in folder.segments()}
    mean_hands = licensed_hands(folder, study)
    clips, notes = {}, []
    for path in motions:
        segment = segments.get(path.stem)
        if segment is None:
            raise InputError(
                f"there is no segment {path.stem!r}",
                where=path,
                remedy="Name the file after its segment ("
                + ", ".join(list(segments)[:3])
                + ", …), or import its recording too, as a new take (--speech)",
            )
        if segment.name in clips:
            raise InputError(
                f"two of the files have the name {path.stem!r}",
                where=path,
                remedy="Give one motion file for each segment",
            )
        clip, motion_notes = _read(path, facts, mean_hands)
        check_same_length(clip, segment, path)
        notes += motion_notes
        clips[segment.name] = _cut_and_place(clip, 0.0, min(clip.duration, segment.duration))
    _require_same_motion(folder, condition, clips)
    for name, clip in clips.items():
        write_clip(folder.clip(condition, name), clip)
    return notes + add_new_condition(folder, study, condition)


def _take_motion(
    folder: StudyFolder, study: Study, take: Take, audio: Audio
) -> tuple[MotionClip | None, float, list[str]]:
    """Return a take's motion, if any, the seconds with both motion and speech, and notes."""
    if take.motion is None:
        return None, audio.duration, []
    clip, notes = _read(take.motion, take, licensed_hands(folder, study))
    difference = abs(audio.duration - clip.duration)
    lengths = f"the motion lasts {clip.duration:.2f} s, the speech {audio.duration:.2f} s"
    if difference > TAKE_TOLERANCE:
        raise InputError(
            lengths,
            where=take.motion,
            remedy=f"They may differ by {TAKE_TOLERANCE} s: check that the files belong together "
            "and that the frame rate is right (--fps)",
        )
    seconds = min(audio.duration, clip.duration)
    if difference > 1e-3:
        notes.append(f"{take.motion.name}: {lengths}; cut to the common {seconds:.2f} s")
    return clip, seconds, notes


def _read(
    path: Path, facts: RecordingFacts, mean_hands: Floats32 | None
) -> tuple[MotionClip, list[str]]:
    return read_recorded(
        path,
        frame_rate=facts.frame_rate,
        joint_map=facts.joint_map,
        mean_hands=mean_hands,
        as_recorded=facts.as_recorded,
    )


def _cut_and_place(clip: MotionClip, start: float, end: float) -> MotionClip:
    """Return an excerpt that is placed by its own frames.

    Otherwise a segment would reveal whether its condition was imported as takes or as segments.
    """
    return place(cut(clip, start, end))[0]


def _make_segments(take: Take, seconds: float) -> list[Segment]:
    """Return the segments of a take with `seconds` of usable motion and speech."""
    length = take.segment_seconds if take.segment_seconds is not None else seconds
    if not length <= seconds + 1e-6:
        raise InputError(
            f"the take lasts {seconds:.1f} s, too short for a segment of {length:g} s",
            where=take.motion or take.speech,
            remedy="Choose shorter segments (--segment)",
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


def _require_imported(study: Study, condition: str, folder: StudyFolder) -> None:
    """Raise `InputError` if motion files cannot be imported for `condition`."""
    check_name(condition, "condition")
    generated = study.generated().get(condition)
    if generated is not None:
        raise InputError(
            f"the motion of {condition!r} is made by the generator {generated.generator!r}",
            where=folder.definition,
            remedy="Import the files under another condition, or remove the generator of this one "
            "first",
        )
    if condition in (*study.conditions, study.catch.condition) and study.is_finished(condition):
        raise InputError(
            f"condition {condition!r} has finished videos instead of motion",
            where=folder.definition,
            remedy="Import the files under another condition, or remove videos = true from this "
            "one first",
        )


def add_new_condition(
    folder: StudyFolder, study: Study, condition: str, *, videos: bool = False
) -> list[str]:
    """Add `condition` to the study file if it is new; return a note."""
    if condition in (*study.conditions, study.catch.condition):
        return []
    add_condition(folder.definition, condition, videos=videos)
    return [f"{folder.definition.name}: condition {condition!r} added"]


def _require_same_motion(
    folder: StudyFolder, condition: str, clips: Mapping[str, MotionClip]
) -> None:
    """Raise `InputError` if `condition` has other motion for a segment."""
    with TemporaryDirectory() as scratch:
        draft = Path(scratch) / "clip.npz"
        for name, clip in clips.items():
            stored = folder.clip(condition, name)
            if not stored.exists():
                continue
            write_clip(draft, clip)
            if draft.read_bytes() != stored.read_bytes():
                raise InputError(
                    f"condition {condition!r} already has other motion for segment {name}",
                    where=stored,
                    remedy="Import this one under another condition, or remove that file first",
                )
