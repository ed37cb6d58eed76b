from __future__ import annotations

from pathlib import Path

import pytest

from motion.body.model import BodyModel, read_body
from renderer.look import default_body


@pytest.fixture(scope="session")
def body_path() -> Path:
    return default_body()


@pytest.fixture(scope="session")
def body(body_path: Path) -> BodyModel:
    return read_body(body_path)
