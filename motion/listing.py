"""Lists in sentences."""

from __future__ import annotations

from collections.abc import Sequence


def listed(words: Sequence[str]) -> str:
    """Return ``a, b and c``; empty where there are no words."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))
