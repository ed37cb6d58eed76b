"""Results as plain data for JSON: the same bytes on every run, and never NaN."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Final

import numpy as np

DIGITS: Final = 10
"""Significant digits of every number: more would differ between machines."""

Plain = None | bool | int | float | str | list["Plain"] | dict[str, "Plain"]


def plain(value: object) -> Plain:
    """Return frozen results, mappings, sequences and numbers as what JSON knows.

    Fields of results keep their order. NaN and infinity become None; the result says beside it
    why there is no number.
    """
    if value is None or isinstance(value, bool | np.bool_):
        return None if value is None else bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return rounded(float(value))
    if isinstance(value, str):
        return value
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(one) for one in value]
    raise TypeError(f"{type(value).__name__} has no form in JSON")


def rounded(value: float) -> float | None:
    """Return a number with `DIGITS` significant digits, None for none."""
    if not math.isfinite(value):
        return None
    return float(f"{value:.{DIGITS}g}") + 0.0


def as_json(value: object) -> str:
    """Return results as the text of a JSON file."""
    return json.dumps(plain(value), ensure_ascii=False, allow_nan=False, indent=2) + "\n"
