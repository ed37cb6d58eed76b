"""A stimulus: what is seen in one picture, and what is heard with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self


@dataclass(frozen=True, kw_only=True)
class Stimulus:
    """One motion with the speech heard with it.

    Attributes
    ----------
    condition : str
        Whose motion.
    segment : str
        For which segment it was made.
    speech : str or None
        The segment that is heard: its own, another one, or None for silence.
    """

    condition: str
    segment: str
    speech: str | None

    @classmethod
    def own(cls, condition: str, segment: str) -> Self:
        """Return the motion of `condition` for `segment`, heard with its own speech."""
        return cls(condition=condition, segment=segment, speech=segment)


Content = tuple[Stimulus, ...]
"""What one video shows: one stimulus, or two side by side with one sound."""
