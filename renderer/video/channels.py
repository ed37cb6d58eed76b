"""In which three channels a picture is drawn: red, green and blue, or a video's own."""

from __future__ import annotations

from typing import Final

import numpy as np

_RED, _BLUE = 0.2126, 0.0722
_LUMA: Final = np.array([_RED, 1 - _RED - _BLUE, _BLUE])

RGB: Final = np.eye(4)
"""Leaves red, green and blue as they are."""

VIDEO: Final = np.zeros((4, 4))
"""From red, green, blue and 1 to luma, blue and red difference, and 1, all from 0 to 1.

Rec. ITU-R BT.709-6, items 3.2 to 3.4, in the 8-bit levels 16 to 235 and 16 to 240. It is linear, so
that a vertex shader may apply it, and all that is left for later is to average.
"""
VIDEO[0, :3] = 219 / 255 * _LUMA
VIDEO[1, :3] = 224 / 255 * ([0, 0, 1] - _LUMA) / (2 * (1 - _BLUE))
VIDEO[2, :3] = 224 / 255 * ([1, 0, 0] - _LUMA) / (2 * (1 - _RED))
VIDEO[:3, 3] = np.array([16, 128, 128]) / 255
VIDEO[3, 3] = 1
