"""Contact sheets to look at: every avatar in a dozen poses, whole and close by.

``python -m renderer.avatar_sheet FOLDER [AVATAR ...]`` writes one picture per avatar and framing.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from motion.body import BodyModel, read_body
from motion.skeleton import forward_kinematics, joint_index
from renderer.avatars import AVATARS
from renderer.body_asset import default_body
from renderer.clip_video import Stage
from renderer.framing import Camera
from renderer.look import Look
from renderer.sample_poses import SAMPLE_POSES, sample_clip
from renderer.stills import still

COLUMNS: Final = 4

FRAMINGS: Final[Mapping[str, tuple[str, float]]] = MappingProxyType({
    "full body": ("spine1", 2.05), "upper body": ("spine3", 1.25), "face": ("head", 0.36),
    "left hand": ("left_middle1", 0.30), "right hand": ("right_middle1", 0.30),
})  # fmt: skip
"""What each sheet shows: a joint in the middle, and how many metres around it."""

_FIELD_OF_VIEW: Final = 20.0
_ABOVE_JOINT: Final = {"head": 0.035, "spine1": -0.14, "spine3": 0.06}


def main() -> None:
    """Write the sheets that the command line names."""
    if len(sys.argv) < 2:
        raise SystemExit("usage: python -m renderer.avatar_sheet FOLDER [AVATAR ...]")
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or AVATARS:
        body = default_body(name)
        for framing in FRAMINGS:
            path = folder / f"{name} {framing}.png".replace(" ", "_")
            avatar_sheet(body, framing).save(path)
            print(path)


def avatar_sheet(body: Path, framing: str, *, size: int = 480, aside: float = 0.0) -> Image.Image:
    """Return one picture of a body in all sample poses.

    Parameters
    ----------
    body : Path
        The body's file.
    framing : str
        One of `FRAMINGS`.
    size : int
        Pixels along each side of one pose.
    aside : float
        Radians that the camera stands to the body's left.
    """
    model = read_body(body)
    rows = -(-len(SAMPLE_POSES) // COLUMNS)
    sheet = Image.new("RGB", (size * COLUMNS, size * rows))
    for number, pose in enumerate(SAMPLE_POSES.values()):
        clip = sample_clip(pose)
        target = _joint(model, clip.poses, FRAMINGS[framing][0])
        camera = _camera(target, FRAMINGS[framing][1], aside)
        with Stage(body, camera, replace(Look(), size=size)) as stage:
            picture = still(stage, clip, 0.0)
        sheet.paste(picture, (number % COLUMNS * size, number // COLUMNS * size))
    return sheet


def _joint(model: BodyModel, poses: NDArray[np.float32], name: str) -> NDArray[np.float64]:
    """Return where joint `name` is in the posed body, a little moved for a better picture."""
    positions, _ = forward_kinematics(poses, np.zeros((1, 3)), model.joints(np.zeros(0)))
    return np.asarray(
        positions[0, joint_index(name)] + np.array([0.0, _ABOVE_JOINT.get(name, 0.0), 0.0])
    )


def _camera(target: NDArray[np.float64], width: float, aside: float) -> Camera:
    """Return a level camera that sees `width` metres around `target`."""
    distance = width / 2 / np.tan(np.radians(_FIELD_OF_VIEW / 2))
    eye = target + distance * np.array([np.sin(aside), 0.0, np.cos(aside)])
    x, y, z = (float(value) for value in eye)
    a, b, c = (float(value) for value in target)
    return Camera(eye=(x, y, z), target=(a, b, c), field_of_view=_FIELD_OF_VIEW)


if __name__ == "__main__":
    main()
