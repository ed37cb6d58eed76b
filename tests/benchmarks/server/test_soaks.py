"""A short run of what `make soak` does for long."""

from pathlib import Path

import pytest

from benchmarks.server.databases import Backend
from benchmarks.server.kill_soak import Strain, kill_soak
from benchmarks.server.log_secrets import secrets_in
from benchmarks.server.malformed_soak import malformed_soak
from tests.support.servers.throwaway_postgresql import programs


@pytest.mark.slow
@pytest.mark.parametrize(("backend", "seed"), [("sqlite", 40), ("postgresql", 45)])
def test_no_acknowledged_answer_is_lost_or_doubled_when_everything_is_killed(
    backend: Backend, seed: int
) -> None:
    if backend == "postgresql" and programs() is None:
        pytest.skip("PostgreSQL is not installed")

    outcome = kill_soak(backend, Strain(sessions=16, trials=3, kills=3, seed=seed))

    assert outcome.problems == ()
    assert outcome.acknowledged == 16 * 3 * 2
    assert sum(outcome.killed.values()) == 3
    everything = {"worker", "arbiter"} | ({"database"} if backend == "postgresql" else set())
    assert set(outcome.killed) == everything
    # Participants were in the midst of something.
    assert outcome.sent_again > 0


@pytest.mark.slow
def test_malformed_requests_neither_fail_nor_leave_anything_behind() -> None:
    outcome = malformed_soak("sqlite", requests=400, seed=5)

    assert outcome.problems == ()
    assert sum(outcome.answers.values()) == 400
    # They got past the entrance.
    assert {403, 404, 405, 409, 413, 422} <= set(outcome.answers)


@pytest.mark.parametrize(
    "line",
    [
        "Traceback (most recent call last):",
        "Failed at GET /take/abc",
        "key Zb3JpcbOb9jXQd0n1_wYc-7uT5kLm8Qa failed",
        "Invalid request from ip=203.0.113.9",
        "postgresql://me:word@host/db",
    ],
)
def test_secrets_in_a_log_are_found_without_false_alarms(tmp_path: Path, line: str) -> None:
    log = tmp_path / "log"
    log.write_text("[2026-01-01 10:00:00 +0000] [1234] [ERROR] Worker (pid:5) was sent SIGKILL!\n")
    assert secrets_in(log) == ()
    log.write_text(f"All is well.\n{line}\n")
    assert len(secrets_in(log)) == 1
