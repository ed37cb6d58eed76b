import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="session")
def closed_form(shared_data: Path) -> Mapping[str, Any]:
    """Return scores whose values follow from formulas, or skip the test."""
    path = shared_data.parent / "reference" / "stats" / "metrics_closed_form.json"
    if not path.is_file():
        pytest.skip("the closed-form scores (../shared/reference/stats) are not here")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found
