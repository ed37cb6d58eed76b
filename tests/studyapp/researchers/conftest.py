"""What the tests of researchers' accounts share."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def hashing_costs_little(cheap_passwords: None) -> None:
    """Spare these tests the cost of real hashes."""
