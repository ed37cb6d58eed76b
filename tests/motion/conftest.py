"""The default body, which several tests of motion use."""

import pytest

from motion.body.model import BodyModel, read_body
from renderer.look import default_body


@pytest.fixture(scope="session")
def body() -> BodyModel:
    return read_body(default_body())
