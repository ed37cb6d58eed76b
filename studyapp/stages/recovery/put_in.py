"""What a rehearsal's participants were given to prefer, as the analysis knows it."""

from __future__ import annotations

from analysis.results.known_values import KnownValue
from studyapp.rehearsal.record import Truth


def known_values(truth: Truth) -> tuple[KnownValue, ...]:
    """Return everything that was put in."""
    return tuple(
        KnownValue(
            about=expected.about,
            part=expected.part,
            question=expected.question,
            measure=expected.measure,
            value=expected.value,
            on_these_segments=expected.value_on_these_segments,
        )
        for expected in truth.expected
    )
