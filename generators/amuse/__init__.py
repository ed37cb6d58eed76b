"""AMUSE: speech taken apart into content, emotion and style, and motion by latent diffusion.

Chhatre et al., CVPR 2024.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from generators.amuse.network_file import load_released as load_released


def __getattr__(name: str) -> object:
    """Import the networks when they are asked for: listing generators needs no torch."""
    if name == "load_released":
        from generators.amuse.network_file import load_released

        return load_released
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
