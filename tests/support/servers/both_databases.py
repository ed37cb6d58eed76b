"""The mark of a test whose statements must work on both databases."""

import pytest

BOTH = pytest.mark.parametrize("database_url", ["sqlite", "postgresql"], indirect=True)
