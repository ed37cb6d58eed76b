"""Data with expected results, if available."""

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

REFERENCE = Path(__file__).parents[3] / "shared" / "reference" / "stats"

with_reference = pytest.mark.skipif(
    not REFERENCE.exists(), reason="the reference results are not here"
)


def reference_ratings() -> tuple[pd.DataFrame, dict[str, Any]]:
    """Return ratings (participant, item, method, rating) and R's results."""
    expected = json.loads((REFERENCE / "ratings.json").read_text("utf-8"))
    return pd.read_csv(REFERENCE / "ratings.csv"), expected
