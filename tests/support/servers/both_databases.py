"""The mark of a test whose statements both databases must understand alike."""

from __future__ import annotations

import pytest

BOTH = pytest.mark.parametrize("database_url", ["sqlite", "postgresql"], indirect=True)
