"""One camera for a whole study."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A camera that looks level or not, but always stands upright; JSON-able through `asdict`.

    Attributes
    ----------
    eye, target : tuple of float
        Where it is and what it looks at, in metres.
    field_of_view : float
        Angle that the picture's height (and width) covers, in degrees.
    """

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    field_of_view: float
