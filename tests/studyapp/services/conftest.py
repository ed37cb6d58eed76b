"""What is done with the tables is tested on both databases."""

from __future__ import annotations

import pytest


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Repeat every test that uses a database on SQLite and on PostgreSQL, unless it says which."""
    chosen = [mark.args[0] for mark in metafunc.definition.iter_markers("parametrize")]
    if "database_url" in metafunc.fixturenames and "database_url" not in chosen:
        metafunc.parametrize("database_url", ["sqlite", "postgresql"], indirect=True)
