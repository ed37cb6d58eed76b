"""Figures that play motion in a page, their scripts and data, and a page of its own for them."""

import base64
import hashlib
import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import soundfile
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from motion.audio import Audio
from motion.body.abilities import read_expression_matrix
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.errors import InputError
from motion.files import write_text
from renderer.framing import frame_clips
from renderer.look import Look
from renderer.viewer.packing import avatar_body, packed_avatar, track

MAX_CLIPS: Final = 6
"""Largest number of clips side by side; more would be too small to judge."""

SCRIPTS: Final = ("three.min.js", "viewer.js")
"""Scripts of a page, in loading order."""

STYLE: Final = "viewer.css"

FILES: Final = Path(str(files("renderer.viewer")))
"""The folder of scripts and style, for servers."""

_COMPRESSION: Final = 0.6
"""Compression of MP3, from 0 to 1: speech stays clear at about 6 kB per second."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """Clips that play side by side and in sync.

    Attributes
    ----------
    name : str
        Title of the scene, on the start button.
    clips : mapping of str to MotionClip
        Clips by caption; at most `MAX_CLIPS`.
    speech : Audio or None
        The speech, as long as the clips.
    """

    name: str
    clips: Mapping[str, MotionClip]
    speech: Audio | None = None


def viewed_body(look: Look) -> BodyModel:
    """Return the avatar of `look`, with its expression matrix, if any."""
    matrix = look.expression_matrix
    return replace(
        avatar_body(look.avatar),
        expression_matrix=None if matrix is None else read_expression_matrix(matrix),
    )


def packed_scene(
    scene: Scene, body: BodyModel, look: Look, keep: Callable[[bytes], str]
) -> dict[str, Any]:
    """Return a scene in the format of ``viewer.js``, as JSON values.

    Parameters
    ----------
    scene : Scene
        The scene.
    body : BodyModel
        The body of `viewed_body`.
    look : Look
        The look, which sets the initial view.
    keep : callable
        Stores a clip's track, or the speech as MP3, and returns its address for ``viewer.js``.

    Raises
    ------
    InputError
        If there are no clips, or more than `MAX_CLIPS`.
    """
    if not 0 < len(scene.clips) <= MAX_CLIPS:
        raise InputError(
            f"{len(scene.clips)} motions do not fit side by side",
            remedy=f"Show 1 to {MAX_CLIPS} at a time",
        )
    return {
        "speech": None if scene.speech is None else keep(_mp3(scene.speech)),
        "camera": asdict(frame_clips(scene.clips.values(), body, look)),
        "background": "#{:02x}{:02x}{:02x}".format(*look.background),
        "clips": [
            {"name": name, "source": keep(track(clip, body))} for name, clip in scene.clips.items()
        ],
    }


def data_address(data: bytes) -> str:
    """Return the ``data:`` address of `data`."""
    return f"data:;base64,{base64.b64encode(data).decode()}"


class MotionFigures:
    """Figures of one page. They share one avatar, and equal data are embedded once.

    Parameters
    ----------
    look : Look
        The avatar, its expression matrix, and the initial view.
    avatar : str
        Address of the avatar; empty to embed it.
    """

    def __init__(self, look: Look, *, avatar: str = "") -> None:
        self._body = viewed_body(look)
        self._look = look
        self._embedded: dict[str, str] = {}
        self._avatar = avatar or self._embed(packed_avatar(look.avatar))

    def figure(self, scene: Scene, *, at_once: bool = False) -> Markup:
        """Return the element in which a scene plays.

        Parameters
        ----------
        scene : Scene
            The scene.
        at_once : bool
            Whether it loads with the page rather than on a click; only for the first figure.

        Raises
        ------
        InputError
            If there are no clips, or more than `MAX_CLIPS`.
        """
        facts = packed_scene(scene, self._body, self._look, self._embed)
        return Markup(
            '<figure class="motion-viewer" data-scene="{}"{}>'
            '<button type="button" class="start">Play {}</button></figure>'
        ).format(
            json.dumps({"avatar": self._avatar} | facts),
            Markup(" data-at-once") if at_once else "",
            scene.name,
        )

    def sources(self) -> Markup:
        """Return the elements with the data of all figures made so far, which precede scripts."""
        return Markup("\n").join(
            Markup('<script type="application/octet-stream" id="{}">{}</script>').format(*each)
            for each in self._embedded.items()
        )

    def _embed(self, data: bytes) -> str:
        name = f"data-{hashlib.sha256(data).hexdigest()[:16]}"
        self._embedded[name] = base64.b64encode(data).decode()
        return f"#{name}"


def _mp3(speech: Audio) -> bytes:
    """Return speech as MP3, which all browsers play."""
    data = io.BytesIO()
    soundfile.write(
        data,
        speech.samples,
        speech.sample_rate,
        format="MP3",
        compression_level=_COMPRESSION,
    )
    return data.getvalue()


def scripts() -> tuple[str, ...]:
    """Return the text of `SCRIPTS`, for pages that need no other file."""
    return tuple((FILES / name).read_text("utf-8") for name in SCRIPTS)


def style() -> str:
    """Return the text of `STYLE`."""
    return (FILES / STYLE).read_text("utf-8")


def policy_hash(script: str) -> str:
    """Return the hash by which a page's security policy allows an inline script."""
    return f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"


AVATAR_SCRIPT: Final = "avatar.js"
"""Script of pages that share an avatar; it creates the element that would otherwise be embedded in
each of them."""


def write_shared_files(folder: Path, look: Look) -> None:
    """Write the files that pages in `folder` share: the viewer and the avatar of `look`."""
    for name in (*SCRIPTS, STYLE):
        write_text(folder / name, (FILES / name).read_text("utf-8"))
    properties = {
        "type": "application/octet-stream",
        "id": AVATAR_SCRIPT,
        "textContent": base64.b64encode(packed_avatar(look.avatar)).decode(),
    }
    expression = f'Object.assign(document.createElement("script"), {json.dumps(properties)})'
    write_text(folder / AVATAR_SCRIPT, f"document.head.append({expression});\n")


def write_motion_page(
    path: Path,
    title: str,
    scenes: Sequence[Scene],
    look: Look,
    *,
    shares: bool = False,
) -> None:
    """Write a page of scenes, one below the other, that needs no server.

    Parameters
    ----------
    path : Path
        The page; appears whole, or not at all.
    title : str
        Its heading.
    scenes : sequence of Scene
        The scenes; the first one loads with the page.
    look : Look
        The same as for `MotionFigures`.
    shares : bool
        Whether it uses the files of `write_shared_files` in its folder.
    """
    figures = MotionFigures(look, avatar=f"#{AVATAR_SCRIPT}" if shares else "")
    elements = [figures.figure(scene, at_once=not number) for number, scene in enumerate(scenes)]
    inline_scripts = () if shares else scripts()
    environment = Environment(
        loader=PackageLoader("renderer.viewer", "."), autoescape=True, undefined=StrictUndefined
    )
    write_text(
        path,
        environment.get_template("page.html").render(
            title=title,
            figures=elements,
            sources=figures.sources(),
            beside=(AVATAR_SCRIPT, *SCRIPTS) if shares else (),
            scripts={policy_hash(script): Markup(script) for script in inline_scripts},  # noqa: S704
            style=Markup(style()),  # noqa: S704 - our own file, as the scripts are
        ),
    )
