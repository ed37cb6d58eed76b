"""Contact sheets: every avatar in a dozen poses, whole and close up.

``python -m tools.avatars.sheet FOLDER [AVATAR ...]`` writes one picture per avatar and framing,
and ``everyone.png`` with all of them at rest.
"""

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np
from PIL import Image

from motion.body.model import BodyModel, read_body
from motion.clip import MotionClip
from motion.skeleton import forward_kinematics, joint_index
from renderer.clip_video import Stage, still
from renderer.framing import Camera
from renderer.look import AVATARS, Look, default_body
from tools.avatars.sample_poses import SAMPLE_POSES, sample_clip

COLUMNS: Final = 4

FRAMINGS: Final[Mapping[str, tuple[str, float, float]]] = MappingProxyType({
    "full body": ("spine1", 2.05, -0.14), "upper body": ("spine3", 1.25, 0.06),
    "face": ("head", 0.36, 0.035), "left hand": ("left_middle1", 0.30, 0.0),
    "right hand": ("right_middle1", 0.30, 0.0),
})  # fmt: skip
"""Framing of each sheet: a joint, the width in metres, and the centre's height above the joint."""

_EVERYONE: Final = ("spine3", 0.92, 0.08)
_FIELD_OF_VIEW: Final = 20.0


def main() -> None:
    """Write the sheets that the command line names."""
    if len(sys.argv) < 2:
        raise SystemExit("usage: python -m tools.avatars.sheet FOLDER [AVATAR ...]")
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or AVATARS:
        body = default_body(name)
        for framing in FRAMINGS:
            path = folder / f"{name} {framing}.png".replace(" ", "_")
            avatar_sheet(body, framing).save(path)
            print(path)
    everyone().save(folder / "everyone.png")


def everyone(*, size: int = 400) -> Image.Image:
    """Return one picture of all avatars at rest, side by side."""
    sheet = Image.new("RGB", (size * len(AVATARS), size))
    joint, width, above = _EVERYONE
    for number, name in enumerate(AVATARS):
        body = default_body(name)
        with Stage(body, _camera(width, above, 0.0), replace(Look(), size=size)) as stage:
            clip = _centred(sample_clip(SAMPLE_POSES["blinking"]), read_body(body), joint)
            awake = replace(clip, arkit=None)
            sheet.paste(still(stage, awake, 0.0), (number * size, 0))
    return sheet


def avatar_sheet(body: Path, framing: str, *, size: int = 480, aside: float = 0.0) -> Image.Image:
    """Return one picture of a body in all sample poses.

    Parameters
    ----------
    body : Path
        File of the body.
    framing : str
        One of `FRAMINGS`.
    size : int
        Width and height of one pose in pixels.
    aside : float
        Radians by which the camera is turned to the body's left.
    """
    joint, width, above = FRAMINGS[framing]
    model = read_body(body)
    rows = -(-len(SAMPLE_POSES) // COLUMNS)
    sheet = Image.new("RGB", (size * COLUMNS, size * rows))
    with Stage(body, _camera(width, above, aside), replace(Look(), size=size)) as stage:
        for number, pose in enumerate(SAMPLE_POSES.values()):
            picture = still(stage, _centred(sample_clip(pose), model, joint), 0.0)
            sheet.paste(picture, (number % COLUMNS * size, number // COLUMNS * size))
    return sheet


def _centred(clip: MotionClip, model: BodyModel, joint: str) -> MotionClip:
    """Return `clip` moved so that `joint` is in the middle of the picture."""
    positions, _ = forward_kinematics(clip.poses, clip.trans, model.joints(np.zeros(0)))
    return replace(clip, trans=-positions[:, joint_index(joint)].astype(np.float32))


def _camera(width: float, above: float, aside: float) -> Camera:
    """Return a level camera that sees `width` metres around a point `above` the origin."""
    distance = width / 2 / np.tan(np.radians(_FIELD_OF_VIEW / 2))
    return Camera(
        eye=(float(distance * np.sin(aside)), above, float(distance * np.cos(aside))),
        target=(0.0, above, 0.0),
        field_of_view=_FIELD_OF_VIEW,
    )


if __name__ == "__main__":
    main()
