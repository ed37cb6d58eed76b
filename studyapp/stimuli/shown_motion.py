"""The motion that a study shows, and the body that it shows all of it on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio, read_audio
from motion.body.abilities import BodyAbilities, read_expression_matrix, unsupported
from motion.body.archive import read_mean_hands
from motion.body.model import BodyModel, read_body
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.formats import read_clip
from motion.segment import Segment
from renderer.encoder import SOUND_RATE
from renderer.look import AVATARS, Colour, Look, default_body
from renderer.loudness import at_common_loudness
from renderer.shown_clip import as_shown
from renderer.viewer.avatar import avatar_body
from renderer.viewer.page import MAX_CLIPS, Scene
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

SEGMENT_TOLERANCE: Final = 0.1
"""Seconds by which motion and speech of one segment may differ."""


def body_file(folder: StudyFolder, study: Study) -> Path:
    """Return the licensed body that the study names, else its avatar's, built where needed."""
    if study.video.body:
        return folder.root / Path(study.video.body).expanduser()
    return default_body(study.video.avatar)


def background_of(study: Study) -> Colour:
    """Return the sRGB of what is behind the speaker in the study's videos."""
    red, green, blue = bytes.fromhex(study.video.background[1:])
    return red, green, blue


def expression_matrix_file(folder: StudyFolder, study: Study) -> Path | None:
    """Return the expression matrix that the study names; a relative path begins at its folder."""
    given = study.video.expression_matrix
    return folder.root / Path(given).expanduser() if given else None


def shown_body(folder: StudyFolder, study: Study) -> BodyModel:
    """Return the study's body with its expression matrix."""
    matrix = expression_matrix_file(folder, study)
    return read_body(body_file(folder, study), expression_matrix=matrix)


def licensed_hands(folder: StudyFolder, study: Study) -> NDArray[np.float32] | None:
    """Return the mean hands, shape (30, 3), of the licensed body that the study names, if any."""
    body = body_file(folder, study) if study.video.body else None
    return read_mean_hands(body) if body is not None and body.is_file() else None


def shown_abilities(folder: StudyFolder, study: Study) -> BodyAbilities:
    """Return what the study's body can show, without building an avatar's.

    Raises
    ------
    InputError
        If the licensed body or the expression matrix cannot be read.
    """
    if study.video.body:
        return shown_body(folder, study).abilities
    matrix = expression_matrix_file(folder, study)
    if matrix is not None:
        read_expression_matrix(matrix)
    has_face = AVATARS[study.video.avatar].has_face
    return BodyAbilities(
        has_face=has_face,
        has_arkit_slots=has_face,
        has_matrix=matrix is not None,
        shapes=0,
    )


def left_out(shown: Iterable[tuple[str, MotionClip]], body: BodyAbilities) -> tuple[str, ...]:
    """Return, once for each condition, what of its motion the body cannot show.

    Parameters
    ----------
    shown : iterable of (condition, clip)
        Every clip as it is shown: of a frozen face nothing is left out.
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
            f"the motion lasts {clip.duration:.2f} s, the speech of segment {segment.name} "
            f"{segment.duration:.2f} s",
            where=where,
            remedy=f"They may differ by {SEGMENT_TOLERANCE} s: cut the longer one, "
            "or check the frame rate",
        )


def moved_clips(study: Study, segments: Sequence[Segment]) -> list[tuple[str, Segment]]:
    """Return every (condition, segment) whose motion is shown, condition after condition."""
    moved = {
        (stimulus.condition, stimulus.segment): stimulus.condition
        for content in study.contents(segments)
        for stimulus in content
        if not study.is_finished(stimulus.condition)
    }
    order = dict.fromkeys(moved.values())
    return [(c, s) for c in order for s in segments if (c, s.name) in moved]


def read_motion_shown(
    folder: StudyFolder, study: Study, segments: Sequence[Segment]
) -> dict[tuple[str, str], MotionClip]:
    """Return each (condition, segment)'s clip as it is shown, frozen channels still.

    A clip that cannot be read, or does not fit its speech, is left out: making its video fails,
    which is reported, and the rest goes on.

    Raises
    ------
    InputError
        If clips are missing, or none can be used.
    """
    wanted = moved_clips(study, segments)
    if not wanted:
        raise InputError(
            "all videos of this study were brought finished, and there is no motion to draw",
            where=folder.definition,
            remedy="Take a study whose conditions have motion",
        )
    missing = [(c, s) for c, s in wanted if not folder.clip(c, s.name).exists()]
    if missing:
        condition, segment = missing[0]
        imported = condition in study.conditions and study.conditions[condition].generator is None
        remedy = "Bring it in with 'motionjury import'" if imported else "Run 'motionjury generate'"
        raise InputError(
            f"{len(missing)} of {len(wanted)} motion clips are missing, the first is condition "
            f"{condition!r} for segment {segment.name}",
            where=folder.clip(condition, segment.name),
            remedy=remedy,
        )
    shown = {}
    broken: list[InputError] = []
    for condition, segment in wanted:
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
    """Return how a study's motion looks in a browser: always on its avatar.

    A licensed body is never written into a page, which its licence forbids to pass on.
    """
    return Look(
        frame_rate=study.video.frame_rate,
        framing=study.video.framing,
        view=study.video.view,
        background=background_of(study),
        avatar=study.video.avatar,
        expression_matrix=expression_matrix_file(folder, study),
    )


def segment_scene(
    folder: StudyFolder,
    study: Study,
    segment: Segment,
    conditions: Iterable[str],
    *,
    heard: Segment | None,
) -> tuple[Scene, dict[str, str]]:
    """Return a segment's clips as participants see them, with what is heard.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    study : Study
        Its definition.
    segment : Segment
        What the motion is made for.
    heard : Segment or None
        Whose speech is heard, as far as the motion goes; None for silence.
    conditions : iterable of str
        Whose clips; only the first `MAX_CLIPS` that can be read are shown.

    Returns
    -------
    Scene
        Its clips by condition; none where no motion can be read, and no speech where that cannot.
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
            missing[condition] = f"{MAX_CLIPS} others are shown already"
        else:
            try:
                clip, rate = read_clip(path), study.video.frame_rate
                clips[condition] = as_shown(clip, body, path, segment.duration, study.freeze, rate)
            except InputError as error:
                missing[condition] = error.what
    return Scene(name=segment.name, clips=clips, speech=_speech(folder, segment, heard)), missing


def _speech(folder: StudyFolder, segment: Segment, heard: Segment | None) -> Audio | None:
    """Return the speech of `heard`, no longer than `segment`; None where it cannot be read."""
    if heard is None:
        return None
    try:
        speech = read_audio(folder.recording(heard), sample_rate=SOUND_RATE)
    except InputError:
        return None
    end = min(heard.end, heard.start + segment.duration)
    return at_common_loudness(speech.cut(heard.start, end))
