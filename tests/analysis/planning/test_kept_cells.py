"""Cells of a plan are kept for as long as their version is the same, which must be true."""

from __future__ import annotations

import pytest

from analysis.planning import cell
from analysis.planning.cell import Task, simulated
from analysis.planning.part import Opinions
from analysis.planning.power import Effort
from analysis.planning.size import Sketch

# Where a change is wanted, raise the version in the module and write its new numbers here.
POWERS = {
    "2": {
        "pairs": [0.65625, 0.59, 0.71, 0.073482],
        "ratings": [0.51, 0.51, 0.65, 0.039911],
        "rankings": [0.43875, 0.385625, 0.7, 0.058083],
    }
}

SKETCHES = (
    Sketch(kind="pairs", own_participants=True, questions=2),
    Sketch(kind="ratings", conditions=3),
    Sketch(kind="rankings", conditions=3, questions=2),
)


@pytest.mark.parametrize("sketch", SKETCHES, ids=lambda one: one.kind)
def test_a_study_that_is_simulated_otherwise_has_another_version(sketch: Sketch) -> None:
    task = Task(
        size=sketch.size(20, 20, excluded=0.0),
        effect=0.5,
        opinions=Opinions(),
        effort=Effort(quick=100, exact=20),
        seed=3,
    )
    (found,) = simulated(task).powers
    assert [found.power, found.alone, found.uncorrected, found.error] == pytest.approx(
        POWERS[cell.VERSION][sketch.kind], abs=1e-6
    )
