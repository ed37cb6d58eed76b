"""Whether the study's camera shows what its questions ask about."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from motion.body.abilities import BodyAbilities
from motion.clip import MotionClip, freeze
from renderer.look import BACKGROUND
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.stimuli.render_plan import study_camera
from studyapp.stimuli.shown_motion import background_of, shown_body

LEAST_PIXELS: Final = 120
"""Height of a head below which lips and brows are a few pixels."""

_HEAD: Final = 0.26
"""Metres from the chin to the top of the hair."""

_OF_FACES: Final = re.compile(
    r"\b(faces?|facial|lips?|mouth)\b|gesicht|mimik|lippen|顔|表情", re.IGNORECASE
)


def look_findings(
    material: Material, body: BodyAbilities, clips: Mapping[str, Sequence[MotionClip]]
) -> Iterator[Finding]:
    """Say what the framing shows that does not move, and where a face is asked about but small.

    Parameters
    ----------
    body : BodyAbilities
        What the study's body shows.
    clips : mapping of str to sequence of MotionClip
        The motion that there is, by condition.
    """
    study = material.study
    if not any(clips.values()):
        return
    part = {"face": "face", "hands": "hands"}.get(study.video.framing, "")
    if part in study.freeze:
        yield finding("framed-part-still", framing=part, why="freeze holds it still")
    elif part == "face" and not body.has_face:
        yield finding("framed-part-still", framing=part, why="the study's body has no face")
    if background_of(study) != BACKGROUND:
        yield finding("background-unlike-pages")
    asked = [question.name for question in study.questions if _OF_FACES.search(question.text)]
    if asked and not part and body.has_face and "face" not in study.freeze:
        pixels = _head_pixels(material, clips)
        if pixels < LEAST_PIXELS:
            yield finding("face-small", question=asked[0], pixels=pixels)


def _head_pixels(material: Material, clips: Mapping[str, Sequence[MotionClip]]) -> int:
    """Return how high a head is in the videos."""
    study = material.study
    shown = [freeze(clip, study.freeze) for made in clips.values() for clip in made]
    camera = study_camera(shown, study, shown_body(material.folder, study))
    distance = float(np.linalg.norm(np.subtract(camera.eye, camera.target)))
    seen = 2 * distance * np.tan(np.radians(camera.field_of_view / 2))
    return round(float(study.video.size * _HEAD / seen))
