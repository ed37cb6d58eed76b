"""The motion that a study shows, and the body that performs it."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from motion.arrays import Floats32
from motion.audio import Audio, read_audio
from motion.body.abilities import unsupported
from motion.body.archive import read_mean_hands
from motion.body.model import BodyModel, read_body
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.formats import read_clip
from motion.segment import Segment
from renderer.encoder import SOUND_RATE
from renderer.look import Look, default_body
from renderer.loudness import at_common_loudness
from renderer.shown_clip import as_shown
from renderer.viewer.packing import avatar_body
from renderer.viewer.page import MAX_CLIPS, Scene
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

SEGMENT_TOLERANCE: Final = 0.1
"""Seconds by which motion and speech of a segment may differ."""


def body_file(folder: StudyFolder, study: Study) -> Path:
    """Return the file of the study's licensed body, or of its avatar, which is built if needed."""
    if study.video.body:
        return folder.root / Path(study.video.body).expanduser()
    return default_body(study.video.avatar)


def expression_matrix_file(folder: StudyFolder, study: Study) -> Path | None:
    """Return the study's expression matrix, whose path is relative to the study folder."""
    name = study.video.expression_matrix
    return folder.root / Path(name).expanduser() if name else None


def shown_body(folder: StudyFolder, study: Study) -> BodyModel:
    """Return the study's body with its expression matrix."""
    matrix = expression_matrix_file(folder, study)
    return read_body(body_file(folder, study), expression_matrix=matrix)


def licensed_hands(folder: StudyFolder, study: Study) -> Floats32 | None:
    """Return the mean hands, shape (30, 3), of the study's licensed body, if there is one."""
    body = body_file(folder, study) if study.video.body else None
    return read_mean_hands(body) if body is not None and body.is_file() else None


def left_out(shown: Iterable[tuple[str, MotionClip]], body: BodyModel) -> tuple[str, ...]:
    """Return the motion that the body cannot show, as a sentence per condition.

    Parameters
    ----------
    shown : iterable of (condition, clip)
        All clips, with still frozen channels.
    """
    sentences = {
        f"{condition}: {sentence}": None
        for condition, clip in shown
        for sentence in unsupported(clip, body)
    }
    return tuple(sentences)


def check_same_length(clip: MotionClip, segment: Segment, where: Path) -> None:
    """Raise `InputError` if a clip and the speech of its segment differ by more than 0.1 s."""
    difference = abs(clip.duration - segment.duration)
    if difference > SEGMENT_TOLERANCE + 1e-6:
        raise InputError(
            f"the motion lasts {clip.duration:.2f} s, but the speech of segment {segment.name} "
            f"{segment.duration:.2f} s",
            where=where,
            remedy=f"They may differ by {SEGMENT_TOLERANCE} s: cut the longer one, or check the "
            "frame rate",
        )


def shown_clips(study: Study, segments: Sequence[Segment]) -> list[tuple[str, Segment]]:
    """Return all (condition, segment) whose motion is shown, by condition."""
    shown = {
        (stimulus.condition, stimulus.segment): stimulus.condition
        for content in study.contents(segments)
        for stimulus in content
        if not study.is_finished(stimulus.condition)
    }
    order = dict.fromkeys(shown.values())
    return [(c, s) for c in order for s in segments if (c, s.name) in shown]


def read_motion_shown(
    folder: StudyFolder, study: Study, segments: Sequence[Segment]
) -> dict[tuple[str, str], MotionClip]:
    """Return the clips by (condition, segment), with still frozen channels.

    A clip that cannot be read, or does not fit its speech, is omitted: rendering it will fail and
    be reported.

    Raises
    ------
    InputError
        If clips are missing, or none can be used.
    """
    keys = shown_clips(study, segments)
    if not keys:
        raise InputError(
            "this study has only finished videos and no motion to draw",
            where=folder.definition,
            remedy="Take frames from the videos with any video tool",
        )
    missing = [(c, s) for c, s in keys if not folder.clip(c, s.name).exists()]
    if missing:
        condition, segment = missing[0]
        imported = condition in study.conditions and study.conditions[condition].generator is None
        remedy = "Import it with 'motionjury import'" if imported else "Run 'motionjury generate'"
        raise InputError(
            f"{len(missing)} of {len(keys)} motion clips are missing, the first one of condition "
            f"{condition!r} for segment {segment.name}",
            where=folder.clip(condition, segment.name),
            remedy=remedy,
        )
    shown = {}
    broken: list[InputError] = []
    for condition, segment in keys:
        path = folder.clip(condition, segment.name)
        try:
            clip = read_clip(path)
            check_same_length(clip, segment, path)
        except InputError as error:
            broken.append(error)
        else:
            shown[condition, segment.name] = freeze(clip, study.freeze)
    if broken and not any(name != study.catch.condition for name, _ in shown):
        raise broken[0]
    return shown


def study_look(folder: StudyFolder, study: Study) -> Look:
    """Return the look of a study's videos.

    In a browser, motion is always shown on the avatar: the licence of a body forbids to distribute
    it in a page.
    """
    red, green, blue = bytes.fromhex(study.video.background[1:])
    return Look(
        size=study.video.size,
        frame_rate=study.video.frame_rate,
        framing=study.video.framing,
        view=study.video.view,
        background=(red, green, blue),
        avatar=study.video.avatar,
        expression_matrix=expression_matrix_file(folder, study),
    )


def segment_scene(
    folder: StudyFolder,
    study: Study,
    segment: Segment,
    conditions: Iterable[str],
    *,
    speech: Segment | None,
) -> tuple[Scene, dict[str, str]]:
    """Return a segment's clips as participants see them, with speech.

    Parameters
    ----------
    segment : Segment
        The segment of the motion.
    conditions : iterable of str
        Conditions to show; only the first `MAX_CLIPS` that can be read are shown.
    speech : Segment or None
        The segment that is heard, up to the end of the motion; None for silence.

    Returns
    -------
    Scene
        The clips that can be read, by condition, and the speech if it can be read.
    dict of str to str
        Conditions that are left out, and why.
    """
    body = avatar_body(study.video.avatar)
    clips: dict[str, MotionClip] = {}
    missing: dict[str, str] = {}
    for condition in conditions:
        path = folder.clip(condition, segment.name)
        if not path.is_file():
            missing[condition] = "there is no motion file"
        elif len(clips) == MAX_CLIPS:
            missing[condition] = f"{MAX_CLIPS} others are already shown"
        else:
            try:
                clip, rate = read_clip(path), study.video.frame_rate
                clips[condition] = as_shown(clip, body, path, segment.duration, study.freeze, rate)
            except InputError as error:
                missing[condition] = error.what
    audio = None if speech is None else _read_speech(folder, speech, segment.duration)
    return Scene(name=segment.name, clips=clips, speech=audio), missing


def _read_speech(folder: StudyFolder, segment: Segment, seconds: float) -> Audio | None:
    """Return at most `seconds` of a segment's speech; None if it cannot be read."""
    try:
        recording = read_audio(folder.recording(segment), sample_rate=SOUND_RATE)
    except InputError:
        return None
    end = min(segment.end, segment.start + seconds)
    return at_common_loudness(recording.cut(segment.start, end))
