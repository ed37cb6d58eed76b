"""DiffSHEG: speech to face and body together, by diffusion (Chen et al., CVPR 2024)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from generators.diffsheg.model import Denoiser as Denoiser
    from generators.diffsheg.network_file import load_released as load_released

__all__ = ["Denoiser", "load_released"]


def __getattr__(name: str) -> object:
    """Import the network when it is asked for: listing generators needs no torch."""
    if name == "Denoiser":
        from generators.diffsheg.model import Denoiser

        return Denoiser
    if name == "load_released":
        from generators.diffsheg.network_file import load_released

        return load_released
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
