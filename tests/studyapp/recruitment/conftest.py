"""What the tests of recruiting share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.studyapp.recruitment.prolific_stand_in import StandIn, served


@pytest.fixture
def stand_in() -> Iterator[StandIn]:
    with served(StandIn()) as running:
        yield running
