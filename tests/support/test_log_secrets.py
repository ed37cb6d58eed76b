from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.log_secrets import secrets_in


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
def test_a_secret_in_a_log_is_found(tmp_path: Path, line: str) -> None:
    log = tmp_path / "log"
    log.write_text(f"All is well.\n{line}\n", encoding="utf-8")

    assert len(secrets_in(log)) == 1


def test_an_ordinary_log_holds_no_secret(tmp_path: Path) -> None:
    log = tmp_path / "log"
    log.write_text("[2026-01-01 10:00:00 +0000] [1234] [ERROR] Worker (pid:5) was sent SIGKILL!\n")

    assert secrets_in(log) == ()
