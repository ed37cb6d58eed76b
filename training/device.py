"""Where networks run: processor or graphics processor, and how many threads torch has."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Lock
from typing import Final, TypeVar

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


First = TypeVar("First")
Second = TypeVar("Second")

_TURN: Final = Lock()


@contextmanager
def torch_threads(number: int) -> Iterator[None]:
    """Give torch so many threads for a while; rounding may differ with their number."""
    before = torch.get_num_threads()
    torch.set_num_threads(number)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def side_by_side(first: Callable[[], First], second: Callable[[], Second]) -> tuple[First, Second]:
    """Return what both compute, `second` on this thread and `first` on another one.

    Each has half of torch's threads meanwhile. Where torch has one thread, `first` runs before
    `second`, so `second` may wait for what `first` tells but not the other way round. The number
    of threads belongs to the whole process, so calls that share several of them take turns.
    """
    with _TURN:
        whole = torch.get_num_threads()
        if whole > 1:
            return _halved(first, second, whole)
    return first(), second()


def _halved(
    first: Callable[[], First], second: Callable[[], Second], whole: int
) -> tuple[First, Second]:
    with torch_threads(whole // 2), ThreadPoolExecutor(1, "side-by-side") as other:
        firstly = other.submit(_without_gradients, first)
        found = second()
        return firstly.result(), found


def _without_gradients(work: Callable[[], First]) -> First:
    """Return what `work` computes; inference mode belongs to a thread."""
    with torch.inference_mode():
        return work()
