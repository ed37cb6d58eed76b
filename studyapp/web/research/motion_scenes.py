"""Motion that researchers turn around, in place of a video that they only play.

What a viewer needs is packed when it is asked for, by a process of its own: that loads what a
server must not. Nothing of it is kept, so that nothing of it is ever out of date.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from itertools import count
from pathlib import Path
from threading import BoundedSemaphore
from typing import Any, Final

from flask import Response, abort, current_app, send_from_directory, url_for

from studyapp.side_process import SideProcessError, output_of
from studyapp.study.design.trial import Content, Stimulus
from studyapp.web.participants.trial_page import letter
from studyapp.web.research.page import page

PROGRAM: Final = "studyapp.stimuli.scene_process"
"""It belongs to a room above this one, and is called by name, as a stranger would."""

VIEWER: Final = "renderer.viewer"
"""Where the viewer's files lie."""

SECONDS: Final = 60
"""Five clips of one minute take two seconds of a processor, and longer where others go first."""

SIDE_BY_SIDE: Final = 6
"""Clips that the viewer has room for."""

_AT_ONCE: Final = BoundedSemaphore(2)
"""Processes that one process of the server has going."""


@dataclass(frozen=True, kw_only=True)
class WantedScene:
    """Motion that plays side by side on one clock.

    Attributes
    ----------
    segment : str
        What it was made for.
    speech : str or None
        The segment that is heard; None for silence.
    clips : tuple of (str, str)
        What stands under each clip, and its condition.
    """

    segment: str
    speech: str | None
    clips: tuple[tuple[str, str], ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """What stands under the clips."""
        return tuple(label for label, _ in self.clips)


def scenes_of(
    segment: str, speech: str | None, clips: Sequence[tuple[str, str]]
) -> list[WantedScene]:
    """Return as many scenes as clips need that were made for a segment, and are heard alike."""
    return [
        WantedScene(
            segment=segment, speech=speech, clips=tuple(clips[first : first + SIDE_BY_SIDE])
        )
        for first in range(0, len(clips), SIDE_BY_SIDE)
    ]


def scenes_of_trial(
    players: Mapping[int, Content], label: Callable[[str, Stimulus], str]
) -> list[WantedScene]:
    """Return the scenes of a trial: what is heard with the same speech plays together.

    Parameters
    ----------
    players : mapping of int to Content
        What each video shows, by its number; 0 is the reference.
    label : callable
        What stands under a clip, of its letter in the trial and of its stimulus.
    """
    heard: dict[tuple[str, str | None], list[tuple[str, str]]] = {}
    for called, each in _lettered(players):
        clip = (label(called, each), each.condition)
        heard.setdefault((each.segment, each.speech), []).append(clip)
    return [scene for key, clips in heard.items() for scene in scenes_of(*key, clips)]


def _lettered(players: Mapping[int, Content]) -> Iterator[tuple[str, Stimulus]]:
    numbers = count(1)
    for number, content in sorted(players.items()):
        for stimulus in content:
            yield letter(next(numbers)) if number else "Reference", stimulus


def motion_page(
    scenes: Sequence[WantedScene], endpoint: str, *, back: tuple[str, str], **place: Any
) -> str:
    """Return the page on which the motion of a trial is turned around.

    Parameters
    ----------
    endpoint : str
        Sends a scene of the trial, by `place` and its number.
    back : (str, str)
        The address to go back to, and what is there.
    **place
        Which trial it is, its `position` among others.
    """
    addresses = [url_for(endpoint, scene=number, **place) for number in range(len(scenes))]
    return page("motion", scenes=scenes, addresses=addresses, back=back, **place)


def send_scene(folder: Path, wanted: Sequence[WantedScene], number: int) -> Response:
    """Send the scene of a number among those that a page has."""
    if number >= len(wanted):
        abort(404)
    scene = wanted[number]
    clips = (f"{label}={condition}" for label, condition in scene.clips)
    try:
        found = _made("scene", str(folder), scene.segment, scene.speech or "", *clips)
    except _NothingMadeError as error:
        found = json.dumps({"problem": f"There is no motion to play. {error}."}).encode()
    return Response(found, mimetype="application/json")


def viewer_file(filename: str) -> Response:
    """Send a script or the style of the viewer."""
    return send_from_directory(str(files(VIEWER)), filename)


def viewer_avatar(avatar: str) -> Response:
    """Send the body of an avatar."""
    try:
        body = _avatar(avatar)
    except _NothingMadeError as error:
        current_app.logger.error("An avatar cannot be shown: %s", error)
        abort(404)
    response = Response(body, mimetype="application/octet-stream")
    response.cache_control.max_age = current_app.get_send_file_max_age("")
    return response


@lru_cache(maxsize=8)
def _avatar(name: str) -> bytes:
    return _made("avatar", name)


class _NothingMadeError(Exception):
    """The message says why, without a full stop."""


def _made(*arguments: str) -> bytes:
    """Return what the process writes."""
    with _AT_ONCE:
        try:
            return output_of(PROGRAM, *arguments, seconds=SECONDS)
        except subprocess.TimeoutExpired:
            raise _NothingMadeError(f"Packing it took longer than {SECONDS} seconds") from None
        except SideProcessError as error:
            why = str(error) or f"Packing it ended with {error.status}"
            raise _NothingMadeError(why) from None
