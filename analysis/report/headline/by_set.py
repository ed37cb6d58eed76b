"""Results by question of one set."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar, cast

Result = TypeVar("Result")


def of(
    found: Mapping[str, Result] | Mapping[str, Mapping[str, Result]], name: str | None
) -> Mapping[str, Result]:
    """Return the results of the set `name` by question; of all questions where it is None."""
    if name is None:
        return cast("Mapping[str, Result]", found)
    return cast("Mapping[str, Mapping[str, Result]]", found).get(name, {})
