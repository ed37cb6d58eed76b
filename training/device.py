"""Devices of networks, CPU or GPU, and torch's threads."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Lock
from typing import Final, TypeVar

import torch

from motion.errors import InputError

DEVICES: Final = ("cpu", "cuda")


def check_device(device: str) -> None:
    """Raise `InputError` unless `device` is ``cpu`` or an available ``cuda`` device."""
    if device not in DEVICES:
        raise InputError(f"unknown device {device!r}", remedy=f"Use {' or '.join(DEVICES)}")
    if device == "cuda" and not torch.cuda.is_available():
        raise InputError(
            "torch finds no GPU on this machine",
            remedy="Use the device cpu, or install torch with CUDA",
        )


First = TypeVar("First")
Second = TypeVar("Second")

_THREADS_LOCK: Final = Lock()


@contextmanager
def torch_threads(number: int) -> Iterator[None]:
    """Set torch's number of threads in a block; rounding may depend on it."""
    previous = torch.get_num_threads()
    torch.set_num_threads(number)
    try:
        yield
    finally:
        torch.set_num_threads(previous)


def side_by_side(first: Callable[[], First], second: Callable[[], Second]) -> tuple[First, Second]:
    """Run `first` on another thread and `second` on this one; return both results.

    Each gets half of torch's threads. If torch has one thread, `first` runs before `second`, so
    `second` may wait for `first` but not the other way round. The number of threads is a setting of
    the whole process, so simultaneous calls take turns.
    """
    with _THREADS_LOCK:
        threads = torch.get_num_threads()
        if threads > 1:
            with torch_threads(threads // 2), ThreadPoolExecutor(1, "side-by-side") as pool:
                # Inference mode belongs to a thread.
                future = pool.submit(torch.inference_mode()(first))
                result = second()
                return future.result(), result
    return first(), second()
