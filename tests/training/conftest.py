"""What the tests of training share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from training.threads import torch_threads


@pytest.fixture(scope="module", autouse=True)
def one_thread() -> Iterator[None]:
    """Leave torch one thread: tests run beside each other, and threads would wait for threads."""
    with torch_threads(1):
        yield
