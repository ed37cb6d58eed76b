"""A short run of what `make soak` does for long."""

from __future__ import annotations

import pytest

from studyapp.bench.databases import BACKENDS, Backend
from studyapp.bench.kill_soak import Strain, kill_soak
from studyapp.bench.malformed_soak import malformed_soak
from studyapp.bench.throwaway_postgresql import programs


@pytest.mark.slow
@pytest.mark.parametrize("backend", BACKENDS)
def test_no_acknowledged_answer_is_lost_or_doubled_when_everything_is_killed(
    backend: Backend,
) -> None:
    if backend == "postgresql" and programs() is None:
        pytest.skip("PostgreSQL is not installed")

    outcome = kill_soak(backend, Strain(sessions=16, trials=3, kills=5, seed=3))

    assert outcome.problems == ()
    assert outcome.acknowledged == 16 * 3 * 2
    assert sum(outcome.killed.values()) == 5


@pytest.mark.slow
def test_malformed_requests_neither_fail_nor_leave_anything_behind() -> None:
    outcome = malformed_soak("sqlite", requests=1000, seed=5)

    assert outcome.problems == ()
    assert sum(outcome.answers.values()) == 1000
    # They came further than the front door.
    assert {403, 404, 405, 409, 413, 422} <= set(outcome.answers)
