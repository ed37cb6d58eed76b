"""The upper edge of cloth at the neck."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Neckline:
    """A line around the neck, lower in front than behind.

    Attributes
    ----------
    rise : float
        Metres above the joint of the neck.
    slope : float
        Metres that it falls per metre forwards.
    opening : float
        Depth in metres of a V in the front below the line.
    width : float
        Half the V's width at the line, in metres.
    """

    rise: float = -0.012
    slope: float = 0.42
    opening: float = 0.0
    width: float = 0.0

    def depth(self, sitter: Sitter, vertices: Array) -> Array:
        """Return the depth of `vertices` below the line, in metres; negative above it."""
        neck = sitter.joint("neck")
        height = vertices[:, 1] - neck[1] - self.rise
        below = -height - self.slope * (vertices[:, 2] - neck[2])
        if not self.opening:
            return np.asarray(below)
        steep = self.width / self.opening
        beside = (np.abs(vertices[:, 0]) - self.width + steep * below) / np.hypot(1, steep)
        front = vertices[:, 2] > neck[2]
        cut = np.where(front & (below < self.opening), np.minimum(below, beside), below)
        return np.asarray(cut)
