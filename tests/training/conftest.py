"""What the tests of training share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.support.short_training import short_training


@pytest.fixture(scope="module", autouse=True)
def _short_training() -> Iterator[None]:
    with short_training():
        yield
