"""The body that a study shows all motion on, and what of the motion it leaves out."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.body.abilities import BodyAbilities, not_shown
from motion.body.expression_matrix import read_expression_matrix
from motion.body.model import BodyModel, read_body
from motion.clip import MotionClip
from motion.hands import read_mean_hands
from renderer.avatars import AVATARS, default_body
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def body_file(folder: StudyFolder, study: Study) -> Path:
    """Return the licensed body that the study names, else its avatar's, built where needed."""
    if study.video.body:
        return folder.root / Path(study.video.body).expanduser()
    return default_body(study.video.avatar)


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
        for sentence in not_shown(clip, body)
    }
    return tuple(sentences)
