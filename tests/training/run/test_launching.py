from __future__ import annotations

import sys

import pytest

from training.run.launching import group_size, is_leader, run_in_processes

SAYS = "import os, sys; rank = os.environ['RANK']; print('rank', rank, file=sys.stderr); "


def run(code: str, count: int = 3) -> int:
    return run_in_processes(count, [sys.executable, "-c", f"{SAYS}{code}"])


def test_only_the_leader_prints_even_if_all_fail(capfd: pytest.CaptureFixture[str]) -> None:
    assert run("print(*(os.environ[name] for name in ('WORLD_SIZE', 'LOCAL_RANK')))") == 0
    assert capfd.readouterr() == ("3 0\n", "rank 0\n")
    assert run("sys.exit(4)") == 4
    assert capfd.readouterr().err == "rank 0\n"


def test_a_single_failing_process_is_reported_and_ends_the_others(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("training.run.launching._SETTLING", 0.2)
    assert run("import signal; sys.exit(5) if rank == '2' else signal.pause()") == 5
    assert capfd.readouterr().err == "rank 0\nrank 2\n"


def test_a_process_killed_by_a_signal_gives_a_shells_exit_status() -> None:
    assert run("os.kill(os.getpid(), 9)", count=1) == 128 + 9


def test_without_a_launcher_a_process_is_its_own_leader(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("WORLD_SIZE", "RANK", "LOCAL_RANK"):
        monkeypatch.delenv(name, raising=False)
    assert (group_size(), is_leader()) == (1, True)
    # Set by batch systems for other reasons.
    monkeypatch.setenv("WORLD_SIZE", "4")
    monkeypatch.setenv("RANK", "2")
    assert (group_size(), is_leader()) == (1, True)
    monkeypatch.setenv("LOCAL_RANK", "2")
    assert (group_size(), is_leader()) == (4, False)
