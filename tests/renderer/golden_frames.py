"""Comparing a picture with the one stored with the tests. Set ``MOTIONJURY_REGENERATE_GOLDEN=1`` to
update the pictures after an intended change.
"""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

FOLDER = Path(__file__).parent / "golden"
MEAN_TOLERANCE = 0.6
"""Grey levels, of 255, that a picture may differ on average: compilers round differently."""

LARGE_DIFFERENCE = 24
LARGE_SHARE = 0.004


def assert_like_golden(picture: NDArray[np.uint8], name: str, differences: Path) -> None:
    """Fail if the picture differs from the stored one, leaving both in `differences`."""
    kept = FOLDER / f"{name}.png"
    if os.environ.get("MOTIONJURY_REGENERATE_GOLDEN"):
        FOLDER.mkdir(exist_ok=True)
        Image.fromarray(picture).save(kept)
    expected = np.asarray(Image.open(kept).convert("RGB")).astype(int)
    difference = np.abs(expected - picture.astype(int))
    large = (difference.max(axis=2) > LARGE_DIFFERENCE).mean()
    if difference.mean() <= MEAN_TOLERANCE and large <= LARGE_SHARE:
        return
    Image.fromarray(picture).save(differences / f"{name}.png")
    shown = np.clip(difference * 4, 0, 255).astype(np.uint8)
    Image.fromarray(shown).save(differences / f"{name}-difference.png")
    raise AssertionError(
        f"{name} differs by {difference.mean():.2f} grey levels on average and strongly in "
        f"{large:.2%} of its pixels; see {differences}"
    )
