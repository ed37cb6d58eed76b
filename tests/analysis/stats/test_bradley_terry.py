from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.stats.strength_models import BradleyTerry, Votes, bradley_terry
from tests.analysis.reference import REFERENCE, with_reference
from tests.analysis.stats.named_votes import votes_of

CONDITIONS = ("GT", "A", "B", "C", "D", "E")


@pytest.fixture
def votes() -> Votes:
    rows = pd.read_csv(REFERENCE / "comparisons.csv")
    return votes_of(
        list(rows["left"]),
        list(rows["right"]),
        list(np.sign(rows["pref_left"])),
        list(rows["participant"]),
        conditions=CONDITIONS,
    )


def expected(name: str) -> dict[str, Any]:
    result: dict[str, Any] = json.loads((REFERENCE / "bradley_terry.json").read_text("utf-8"))[name]
    return result


def from_the_first(fit: BradleyTerry) -> list[float]:
    """Return the clustered errors of the differences from the first condition."""
    own = np.diagonal(fit.covariance)
    return list(np.sqrt(own + own[0] - 2 * fit.covariance[0])[1:])


@with_reference
@pytest.mark.parametrize("name", ["davidson", "davidson_left_effect"])
def test_strengths_and_clustered_errors_agree_with_the_reference(votes: Votes, name: str) -> None:
    wanted = expected(name)
    result = bradley_terry(votes, left_effect=name == "davidson_left_effect")

    assert result.strengths == pytest.approx([wanted["centred"][c] for c in CONDITIONS], abs=1e-6)
    assert from_the_first(result) == pytest.approx(
        list(wanted["se_cluster_participant_CR0"].values()), rel=1e-4
    )
    assert result.log_likelihood == pytest.approx(wanted["loglik"], abs=1e-6)
    for ours, theirs in (("tie", "log_nu"), ("left", "left_logit")):
        if theirs in wanted:
            assert getattr(result, ours) == pytest.approx(wanted[theirs], abs=1e-6)
    assert result.n == 1800


def made_votes() -> Votes:
    chance = np.random.default_rng(0)
    first = chance.integers(0, 4, 4000)
    second = (first + chance.integers(1, 4, 4000)) % 4
    strength = np.array([0.9, 0.2, -0.3, -0.8])
    share = 1 / (1 + np.exp(strength[second] - strength[first] - 0.4))
    outcome = np.where(chance.uniform(size=4000) < share, 1, -1)
    outcome[chance.uniform(size=4000) < 0.2] = 0
    return Votes(
        conditions=("a", "b", "c", "d"),
        left=first,
        right=second,
        outcome=outcome,
        participant=np.repeat(np.arange(40), 100),
        segment=np.zeros(4000, np.intp),
    )


def test_strengths_add_up_to_zero_and_swapping_sides_turns_the_left_effect() -> None:
    votes = made_votes()
    swapped = replace(votes, left=votes.right, right=votes.left, outcome=-votes.outcome)

    one, other = bradley_terry(votes), bradley_terry(swapped)

    assert one.strengths.sum() == pytest.approx(0, abs=1e-9)
    assert other.strengths == pytest.approx(one.strengths, abs=1e-8)
    assert other.left == pytest.approx(-one.left, abs=1e-8)


def test_one_participant_has_strengths_but_no_clustered_errors_and_says_so() -> None:
    votes = made_votes()
    alone = bradley_terry(replace(votes, participant=np.zeros_like(votes.left), segment=votes.left))

    assert not alone.reason
    assert "one participant" in alone.remark
    assert np.isfinite(alone.strengths).all()
    assert np.isfinite(alone.errors_by_model).all()
    assert np.isnan(alone.errors).all()
    assert np.isnan(alone.errors_two_way).all()
    assert np.isnan(alone.tie_error)
    assert not bradley_terry(votes).remark
