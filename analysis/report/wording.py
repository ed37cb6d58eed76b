"""Numbers and names as a reader wants them: sensible digits, no leading zero, no underscore."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

NO_BREAK: Final = "\u00a0"
"""A space at which no line is broken."""

_ZERO: Final = 1e-9


def name(condition: str) -> str:
    """Return a condition's or a question's name for reading."""
    return condition.replace("_", " ")


def heading(question: str) -> str:
    """Return a name as a heading: its first letter large, the others as they are."""
    text = name(question)
    return text[:1].upper() + text[1:]


def share(value: float) -> str:
    """Return a share with two digits, '.63'; a dash for NaN."""
    if math.isnan(value):
        return "–"
    text = f"{abs(value):.2f}"
    sign = "−" if value < 0 and float(text) else ""
    return sign + (text[1:] if text.startswith("0") else text)


def p_value(value: float) -> str:
    """Return a p value, '< .001', '.012' or '.34'; a dash for NaN."""
    if math.isnan(value):
        return "–"
    if value < 0.001:
        return f"<{NO_BREAK}.001"
    if value > 0.995:
        return "1"
    text = f"{value:.3f}" if value < 0.0995 else f"{value:.2f}"
    return text[1:]


def p_is(value: float) -> str:
    """Return a p value as a sentence has it, 'p < .001' or 'p = .34'."""
    text = p_value(value)
    return f"p {text}" if text.startswith("<") else f"p = {text}"


def percent(value: float) -> str:
    """Return a percentage without decimals; a dash for NaN."""
    return "–" if math.isnan(value) else f"{value:.0f}"


def quantity(value: float) -> str:
    """Return a number with three significant digits; a dash for NaN."""
    return fixed(value, decimals([value], digits=3))


def decimals(values: Iterable[float], *, digits: int) -> int:
    """Return how many decimals show `digits` significant ones of the smallest value.

    Zeros, rounding errors and NaN are passed over.
    """
    sizes = [abs(value) for value in values if abs(value) > _ZERO]
    if not sizes:
        return 0
    return max(0, digits - 1 - math.floor(math.log10(min(sizes))))


def fixed(value: float, decimal_places: int) -> str:
    """Return a number with a fixed count of decimals; a dash for NaN, '0' for rounding errors."""
    if math.isnan(value):
        return "–"
    if abs(value) <= _ZERO:
        return "0"
    text = f"{abs(value):.{decimal_places}f}"
    return f"−{text}" if value < 0 and float(text) else text


def count(number: int, noun: str, plural: str = "") -> str:
    """Return a number with its noun, '1 segment', '8 segments'."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"
