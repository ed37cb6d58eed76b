"""Metrics over motions, statistics over responses, and the report that sets them side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analysis.evaluators.published import load_published

__all__ = ["load_published"]


def __getattr__(name: str) -> object:
    # Loaded when it is asked for: most of the package does without what it needs.
    if name == "load_published":
        from analysis.evaluators.published import load_published

        return load_published
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
