from __future__ import annotations

import itertools

import numpy as np
import pytest

from benchmarks.statistics.__main__ import main
from benchmarks.statistics.beside_python import (
    beside_choix,
    beside_gather,
    made_votes,
    timed,
    why_not_choix,
)
from benchmarks.statistics.beside_r import BesideR, beside_r, made_answers, why_not_r

TINY = ("--side", "8", "--large-side", "10", "--votes", "500", "--resamples", "50")


@pytest.mark.slow
def test_it_agrees_with_r_on_the_answers_it_times() -> None:
    missing = why_not_r()
    if missing:
        pytest.skip(missing)

    found = beside_r(made_answers(12, 8), turns=1)

    assert found.agrees
    assert found.seconds_r > 0


@pytest.mark.skipif(bool(why_not_choix()), reason="choix is not installed")
def test_it_agrees_with_choix_on_the_votes_it_times() -> None:
    assert beside_choix(made_votes(5000), turns=1).strengths_apart < 1e-6


def test_both_bootstraps_spread_alike() -> None:
    assert beside_gather(30, 20, resamples=2000, turns=1).deviations_apart < 0.1


def test_made_votes_have_no_ties_and_all_conditions() -> None:
    votes = made_votes(2000)

    assert set(votes.outcome) == {-1, 1}
    assert set(votes.left) == set(votes.right) == set(range(10))


@pytest.mark.parametrize("apart", ["estimates_apart", "errors_apart", "log_likelihood_apart"])
def test_one_large_difference_is_no_agreement(apart: str) -> None:
    alike = {"estimates_apart": 0.0, "errors_apart": 0.0, "log_likelihood_apart": 0.0}

    assert BesideR(seconds=1, seconds_r=20, **alike).agrees
    assert not BesideR(seconds=1, seconds_r=20, **{**alike, apart: 0.1}).agrees


def test_the_least_of_several_turns_counts() -> None:
    turns = itertools.count(1)

    found, seconds = timed(lambda: np.arange(next(turns)), turns=3)

    assert len(found) == 3
    assert seconds >= 0


def test_what_is_missing_is_skipped_with_its_reason(
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
