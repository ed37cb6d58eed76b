"""Motion that researchers turn around, in place of a video that they only play.

A process of its own packs each scene on request, because it loads what a server must not. Nothing
is cached, so that nothing is ever out of date.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from threading import BoundedSemaphore
from typing import Any, Final, get_args

from flask import Response, abort, current_app, send_from_directory, url_for

from studyapp.session.trials import numbered_stimuli
from studyapp.side_process import SideProcessError, output_of
from studyapp.study.design.trial import Content, Stimulus
from studyapp.study.settings.presentation import Avatar
from studyapp.web.participants.trial_page import letter
from studyapp.web.research.page import page

PROGRAM: Final = "studyapp.stimuli.scene_process"
"""A module of a room above this one, so it is run by name."""

VIEWER: Final = "renderer.viewer"
"""The package with the viewer's files."""

SECONDS: Final = 60
"""Five clips of one minute take two seconds of a processor, which others may use first."""

SIDE_BY_SIDE: Final = 6
"""Clips that the viewer has room for."""

_AT_ONCE: Final = BoundedSemaphore(2)
"""Processes that one process of the server runs side by side."""


@dataclass(frozen=True, kw_only=True)
class Scene:
    """Clips that play side by side on one clock.

    Attributes
    ----------
    segment : str
        The segment they were made for.
    speech : str or None
        The segment that is heard; None for silence.
    clips : tuple of (str, str)
        The label of each clip, and its condition.
    """

    segment: str
    speech: str | None
    clips: tuple[tuple[str, str], ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels of the clips."""
        return tuple(label for label, _ in self.clips)


def scenes_of(segment: str, speech: str | None, clips: Sequence[tuple[str, str]]) -> list[Scene]:
    """Return the scenes of clips that were made for a segment, and are heard with one speech."""
    return [
        Scene(segment=segment, speech=speech, clips=tuple(clips[first : first + SIDE_BY_SIDE]))
        for first in range(0, len(clips), SIDE_BY_SIDE)
    ]


def scenes_of_trial(
    players: Mapping[int, Content], label: Callable[[str, Stimulus], str]
) -> list[Scene]:
    """Return the scenes of a trial: clips with the same speech play together.

    Parameters
    ----------
    players : mapping of int to Content
        The content of each video, by its number; 0 is the reference.
    label : callable
        Returns the label of a clip, from its letter in the trial and its stimulus.
    """
    clips_by_speech: dict[tuple[str, str | None], list[tuple[str, str]]] = {}
    for _, number, stimulus in numbered_stimuli(players):
        name = letter(number) if number else "Reference"
        clip = (label(name, stimulus), stimulus.condition)
        clips_by_speech.setdefault((stimulus.segment, stimulus.speech), []).append(clip)
    return [scene for key, clips in clips_by_speech.items() for scene in scenes_of(*key, clips)]


def motion_page(
    scenes: Sequence[Scene], endpoint: str, *, back: tuple[str, str], **place: Any
) -> str:
    """Return the page on which the motion of a trial is turned around.

    Parameters
    ----------
    endpoint : str
        Sends a scene of the trial, by `place` and its number.
    back : (str, str)
        The address to go back to, and what is there.
    **place
        Identifies the trial, with its `position` among others.
    """
    addresses = [url_for(endpoint, scene=number, **place) for number in range(len(scenes))]
    return page("motion", scenes=scenes, addresses=addresses, back=back, **place)


def send_scene(folder: Path, scenes: Sequence[Scene], number: int) -> Response:
    """Send one of the scenes of a page."""
    if number >= len(scenes):
        abort(404)
    scene = scenes[number]
    clips = (f"{label}={condition}" for label, condition in scene.clips)
    try:
        packed = _run_scene_process("scene", str(folder), scene.segment, scene.speech or "", *clips)
    except SideProcessError as error:
        packed = json.dumps({"problem": f"There is no motion to play. {error}."}).encode()
    return Response(packed, mimetype="application/json")


def viewer_file(filename: str) -> Response:
    """Send a script or the style sheet of the viewer."""
    return send_from_directory(str(files(VIEWER)), filename)


def viewer_avatar(avatar: str) -> Response:
    """Send the body of an avatar."""
    if avatar not in get_args(Avatar):
        abort(404)
    response = Response(_avatar(avatar), mimetype="application/octet-stream")
    response.cache_control.max_age = current_app.get_send_file_max_age("")
    return response


@lru_cache(maxsize=8)
def _avatar(name: str) -> bytes:
    return _run_scene_process("avatar", name)


def _run_scene_process(*arguments: str) -> bytes:
    with _AT_ONCE:
        return output_of(PROGRAM, *arguments, seconds=SECONDS)
