from __future__ import annotations

import pytest

from benchmarks.statistics.__main__ import main
from benchmarks.statistics.beside_python import (
    beside_choix,
    beside_gather,
    made_votes,
    why_not_choix,
)
from benchmarks.statistics.beside_r import beside_r, made_answers, why_not_r

TINY = ("--side", "8", "--large-side", "10", "--votes", "500", "--resamples", "50")


@pytest.mark.slow
def test_timed_models_agree_with_r() -> None:
    missing = why_not_r()
    if missing:
        pytest.skip(missing)

    comparison = beside_r(made_answers(12, 8), turns=1)

    assert comparison.agrees
    assert comparison.seconds_r > 0


@pytest.mark.skipif(bool(why_not_choix()), reason="choix is not installed")
def test_timed_strengths_agree_with_choix() -> None:
    assert beside_choix(made_votes(5000), turns=1).strengths_apart < 1e-6


def test_both_bootstraps_have_the_same_spread() -> None:
    assert beside_gather(30, 20, resamples=2000, turns=1).deviations_apart < 0.1


def test_missing_files_are_skipped_with_a_reason(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("benchmarks.statistics.__main__.why_not_r", lambda: "R is not installed")
    monkeypatch.setattr("benchmarks.statistics.__main__.why_not_choix", lambda: "choix is gone")

    main(TINY)

    lines = capsys.readouterr().out.splitlines()
    assert "clmm_beside_r: skipped, R is not installed" in lines
    assert "bradley_terry_beside_choix: skipped, choix is gone" in lines
    assert all(": " in line for line in lines)
    assert "clmm_large_converged: yes" in lines
