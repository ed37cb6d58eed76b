"""The look of a study's stimuli: size, frame rate, camera, background, avatar, light.

`tools.avatars` makes the avatars' files. Versions are incremented with every visible or audible
change, and files of other versions are made again; tests compare the output of each version.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from motion.errors import InputError

RENDERER_VERSION: Final = "3"
"""Version of the pixels and the sound of clips, pairs and dubbed videos, including the avatars."""

COPY_VERSION: Final = "1"
"""Version of copies for participants."""

CELL_VERSION: Final = "1"
"""Version of the cells of contact sheets."""

BODIES: Final = Path(__file__).parent / "bodies"

Colour = tuple[int, int, int]
"""sRGB, each channel in 0-255."""

BACKGROUND: Final[Colour] = (0xEC, 0xEC, 0xEE)
"""The default background, also that of participants' pages."""

FRAMINGS: Final = ("upper_body", "full_body", "face", "hands")

VIEWS: Final[Mapping[str, float]] = {"front": 0.0, "three_quarter": 35.0}
"""Angle of the camera to the speaker's left, in degrees."""


@dataclass(frozen=True, kw_only=True)
class Avatar:
    """One avatar.

    Attributes
    ----------
    name : str
        The name in `study.toml`.
    description : str
        A line that helps choose an avatar.
    has_face : bool
        Whether it has eyes, brows and a mouth, and shows facial expression.
    """

    name: str
    description: str
    has_face: bool = True

    @property
    def body(self) -> Path:
        """File of the avatar's body, in SMPL-X's ``.npz`` layout."""
        # smplx recognises a model file by the beginning of its name.
        return BODIES / f"smplx_anny_{self.name}.npz"


AVATARS: Final[Mapping[str, Avatar]] = {
    name: Avatar(name=name, **values)
    for name, values in tomllib.loads((BODIES / "avatars.toml").read_text("utf-8")).items()
}
"""All avatars by name; the first is the default."""

FIRST_AVATAR: Final = next(iter(AVATARS))


def default_body(avatar: str = FIRST_AVATAR) -> Path:
    """Return the file of an avatar's body, in SMPL-X's ``.npz`` layout."""
    return AVATARS[avatar].body


@dataclass(frozen=True, kw_only=True)
class Light:
    """A distant light, which shines in one direction.

    Attributes
    ----------
    comes_from : tuple of float
        Direction from the body to the light.
    colour : tuple of float
        Linear RGB in [0, 1].
    intensity : float
        Light that it adds to a surface that faces it.
    """

    comes_from: tuple[float, float, float]
    colour: tuple[float, float, float]
    intensity: float


LIGHTS: Final = (
    Light(comes_from=(-0.55, 0.75, 0.95), colour=(1.0, 0.97, 0.93), intensity=0.78),
    Light(comes_from=(0.95, 0.15, 0.55), colour=(0.90, 0.95, 1.0), intensity=0.26),
    Light(comes_from=(0.35, 0.65, -0.9), colour=(1.0, 1.0, 1.0), intensity=0.35),
)
"""A soft three-quarter key, a fill from the other side, and one from behind."""

AMBIENT_LIGHT: Final = (0.36, 0.365, 0.38)


@dataclass(frozen=True, kw_only=True)
class Look:
    """The common look of a study's stimuli.

    Attributes
    ----------
    size : int
        Pixels along each side of a clip's video; even, 64 to 2160.
    frame_rate : float
        Frames per second of the videos.
    framing : str
        One of `FRAMINGS`: the part of the body in the picture.
    view : str
        One of `VIEWS`: the direction of the camera.
    background : tuple of int
        The colour behind the speaker.
    avatar : str
        One of `renderer.look.AVATARS`.
    expression_matrix : Path or None
        A file for `motion.body.abilities.read_expression_matrix`, which converts clips' faces to
        the body's parameters.
    """

    size: int = 720
    frame_rate: float = 30.0
    framing: str = "upper_body"
    # View and background are not in the text form, which identifies finished videos: the camera
    # includes the view, and a background other than the default is added to it.
    view: str = field(default="front", repr=False)
    background: Colour = field(default=BACKGROUND, repr=False)
    avatar: str = FIRST_AVATAR
    expression_matrix: Path | None = None

    def __post_init__(self) -> None:
        if not 64 <= self.size <= 2160 or self.size % 2:
            raise InputError(
                f"size {self.size} is not usable",
                remedy="Give an even number of pixels from 64 to 2160",
            )
        if not 1 <= self.frame_rate <= 120:
            raise InputError(
                f"frame rate {self.frame_rate} is not usable",
                remedy="Give 1 to 120 frames per second",
            )
        for label, value, known in (
            ("framing", self.framing, FRAMINGS),
            ("view", self.view, tuple(VIEWS)),
            ("avatar", self.avatar, tuple(AVATARS)),
        ):
            if value not in known:
                raise InputError(
                    f"unknown {label} {value!r}", remedy=f"Use one of {', '.join(known)}"
                )
