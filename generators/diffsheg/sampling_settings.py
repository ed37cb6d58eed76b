"""What of DiffSHEG's sampling can be chosen, and the choices that have a name. Loads no torch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Any, Final

from generators.diffsheg.walk import Sampling
from motion.errors import InputError

PRESETS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "smooth": {"jump_count": 2, "keeps_pose": True, "own_noise": True},
        "fast": {"jump_count": 2},
        "careful": {"jump_count": 5},
        "plain": {"jump_count": 1},
    }
)
"""Settings by name: as fast as the release's fast one, but smoother where windows meet and with
poses as varied as the network's; the release's fast one; its careful one; no resampling."""

DEFAULT: Final = "smooth"

_SHARED_MORE: Final[Mapping[str, float]] = MappingProxyType({"smooth": 1.5})
"""By how much more frames the windows of a setting share than the release's."""

_ENTRY_SHARE: Final = 0.6
"""Share of the steps that a continuing window walks where nothing is said: 15 of the paper's 25."""


@dataclass(frozen=True, kw_only=True)
class SamplingSettings:
    """A named setting, and what is to differ from it; see `generators.diffsheg.walk.Sampling`.

    Attributes
    ----------
    preset : str
        One of `PRESETS`.
    steps, overlap, entry, jump_length, jump_count : int or None
        None for what the setting has. `overlap` is the release's for the data set, half as much
        again in ``smooth``; `entry` is three fifths of the steps.
    blend_below : float or None
        None for what the setting has.

    Raises
    ------
    InputError
        If there is no such setting, or nothing can be sampled so.
    """

    preset: str = DEFAULT
    steps: int | None = None
    overlap: int | None = None
    entry: int | None = None
    jump_length: int | None = None
    jump_count: int | None = None
    blend_below: float | None = None

    def __post_init__(self) -> None:
        if self.preset not in PRESETS:
            raise InputError(
                f"there is no sampling called {self.preset!r}",
                remedy=f"Use one of {', '.join(PRESETS)}",
            )
        if self.blend_below is not None and not 0 <= self.blend_below <= 1:
            raise InputError(
                f"motion cannot be blended below a noise of {self.blend_below:g}",
                remedy="Give a standard deviation from 0, for no blending, to 1",
            )
        self.sampling(overlap=0)

    def sampling(self, *, overlap: int) -> Sampling:
        """Return how windows are sampled, of which the release's share `overlap` frames."""
        chosen = {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if field.name != "preset" and getattr(self, field.name) is not None
        }
        shared = round(overlap * _SHARED_MORE.get(self.preset, 1))
        settings = {"overlap": shared, **PRESETS[self.preset], **chosen}
        if self.entry is None and self.steps is not None:
            settings["entry"] = max(1, round(_ENTRY_SHARE * self.steps))
        return Sampling(**settings)
