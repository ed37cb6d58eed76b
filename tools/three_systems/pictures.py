"""The strips of frames beside the page."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from PIL import Image

from motion.files import replacing
from studyapp.study.folder import StudyFolder

_WIDE: Final = 840
_COLOURS: Final = 128


def shown_segment(study: StudyFolder) -> str:
    """Return the shortest segment of the study."""
    return min(study.segments(), key=lambda one: (one.duration, one.name)).name


def write_picture(strip: Path, to: Path) -> None:
    """Write a strip with fewer pixels and colours, so that the repository stays small."""
    with Image.open(strip) as picture:
        high = round(picture.height * _WIDE / picture.width)
        small = picture.convert("RGB").resize((_WIDE, high), Image.Resampling.LANCZOS)
    with replacing(to) as draft:
        small.quantize(_COLOURS, dither=Image.Dither.NONE).save(draft, "png", optimize=True)
