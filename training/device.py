"""Where networks run."""

from __future__ import annotations

from typing import Final

import torch

from motion.errors import InputError

DEVICES: Final = ("cpu", "cuda")


def check_device(device: str) -> None:
    """Raise `InputError` where `device` is neither ``cpu`` nor a ``cuda`` that is there."""
    if device not in DEVICES:
        raise InputError(f"unknown device {device!r}", remedy=f"Use {' or '.join(DEVICES)}")
    if device == "cuda" and not torch.cuda.is_available():
        raise InputError(
            "there is no graphics processor that torch can use here",
            remedy="Use the processor (cpu), or install torch with CUDA",
        )
