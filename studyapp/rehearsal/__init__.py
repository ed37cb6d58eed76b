"""Rehearsing a study: simulated participants with known preferences use its real pages."""

from typing import Final

SPEED: Final = 100.0
"""Speed of a rehearsal's clock, relative to real time."""
