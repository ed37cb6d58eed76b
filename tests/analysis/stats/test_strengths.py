import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.discrete.discrete_model import Logit
from statsmodels.stats.sandwich_covariance import cov_cluster_2groups

from analysis.stats.clustered_mean import ONE_SEGMENT, TWO_WAY
from analysis.stats.strength_differences import MIXED, TwoWayErrors, omnibus, rank_intervals
from analysis.stats.strength_models import Votes, bradley_terry, plackett_luce
from analysis.stats.strengths import FittedStrengths
from tests.analysis.reference import REFERENCE, with_reference
from tests.analysis.results.made_tables import ranking_table
from tests.analysis.stats.tables import votes_of

SYSTEMS = ("GT", "A", "B", "C", "D", "E")


@with_reference
@pytest.mark.parametrize("name", ["davidson", "davidson_left_effect"])
def test_strengths_and_clustered_errors_agree_with_the_reference(name: str) -> None:
    rows = pd.read_csv(REFERENCE / "comparisons.csv").assign(won=lambda t: np.sign(t["pref_left"]))
    columns = (rows[column].tolist() for column in ("left", "right", "won", "participant"))
    reference = json.loads((REFERENCE / "bradley_terry.json").read_text("utf-8"))[name]

    result = bradley_terry(
        votes_of(*columns, conditions=SYSTEMS), left_effect=name == "davidson_left_effect"
    )

    assert result.strengths == pytest.approx([reference["centred"][c] for c in SYSTEMS], abs=1e-6)
    assert result.two_way is not None
    # CR0 has no factor G / (G - 1).
    covariance = result.two_way.by_participant * (1 - 1 / result.participants)
    own = np.diagonal(covariance)
    assert list(np.sqrt(own + own[0] - 2 * covariance[0])[1:]) == pytest.approx(
        list(reference["se_cluster_participant_CR0"].values()), rel=1e-4
    )
    assert result.log_likelihood == pytest.approx(reference["loglik"], abs=1e-6)
    for ours, theirs in (("tie", "log_nu"), ("left", "left_logit")):
        if theirs in reference:
            assert getattr(result, ours) == pytest.approx(reference[theirs], abs=1e-6)
    assert result.n == 1800


def made_votes(taste: float = 1.0, luck: float = 1.0) -> Votes:
    """Thirty participants and twelve segments differ in which of four conditions they favour."""
    chance = np.random.default_rng(3)
    people, items = np.repeat(np.arange(30), 36), np.tile(np.arange(36) % 12, 30)
    worth = taste * chance.normal(size=(30, 4))[people] + luck * chance.normal(size=(12, 4))[items]
    left = chance.integers(4, size=len(people))
    right = (left + chance.integers(1, 4, size=len(people))) % 4
    rows = np.arange(len(people))
    latent = worth[rows, left] - worth[rows, right] + chance.logistic(size=len(people))
    return Votes(
        conditions=("a", "b", "c", "d"),
        left=left,
        right=right,
        outcome=np.where(latent > 0, 1, -1),
        participant=people,
        segment=items,
    )


def errors_of(fit: FittedStrengths) -> TwoWayErrors:
    assert fit.two_way is not None
    return fit.two_way


def with_ties() -> Votes:
    votes = made_votes()
    return replace(votes, outcome=np.where(np.arange(len(votes.outcome)) % 5, votes.outcome, 0))


def test_strengths_sum_to_zero_and_swapping_sides_flips_the_left_effect() -> None:
    votes = with_ties()
    swapped = replace(votes, left=votes.right, right=votes.left, outcome=-votes.outcome)

    one, other = bradley_terry(votes), bradley_terry(swapped)

    assert one.strengths.sum() == pytest.approx(0, abs=1e-9)
    assert other.strengths == pytest.approx(one.strengths, abs=1e-8)
    assert other.left == pytest.approx(-one.left, abs=1e-8)


def test_one_participant_gives_strengths_but_no_clustered_errors() -> None:
    votes = with_ties()
    alone = bradley_terry(replace(votes, participant=np.zeros_like(votes.left), segment=votes.left))

    assert not alone.reason
    assert "one participant" in alone.remark
    assert np.isfinite(alone.strengths).all()
    assert np.isfinite(alone.errors_by_model).all()
    assert np.isnan(alone.errors).all()
    assert alone.two_way is None
    assert np.isnan(alone.tie_error)
    assert not bradley_terry(votes).remark


def as_rankings(votes: Votes) -> pd.DataFrame:
    """Return each vote as a ranking of two, ties as equal ranks."""
    shown = np.column_stack([votes.left, votes.right]).ravel()
    return pd.DataFrame(
        {
            "ranking": np.repeat(np.arange(len(votes.left)), 2),
            "participant": np.repeat(votes.participant, 2),
            "segment": np.repeat(votes.segment, 2),
            "condition": np.array(votes.conditions)[shown],
            "rank": 1 + np.column_stack([votes.outcome < 0, votes.outcome > 0]).ravel(),
        }
    )


def test_for_two_conditions_plackett_luce_equals_davidsons_model_with_ties() -> None:
    votes = with_ties()

    pairs = bradley_terry(votes, left_effect=False)
    ranked = plackett_luce(as_rankings(votes), votes.conditions)

    assert ranked.strengths == pytest.approx(pairs.strengths, abs=1e-8)
    assert ranked.errors == pytest.approx(pairs.errors, rel=1e-6)
    assert errors_of(ranked).errors == pytest.approx(errors_of(pairs).errors, rel=1e-3)
    assert ranked.ties[2] == pytest.approx(pairs.tie, abs=1e-8)
    assert ranked.log_likelihood == pytest.approx(pairs.log_likelihood)


def test_only_the_order_of_ranks_counts() -> None:
    two = as_rankings(votes_of(["a", "b"], ["b", "a"], [1, 1], ["P", "Q"]))
    for table in (two, two.assign(rank=two["rank"] * 10)):
        assert plackett_luce(table, "ab").log_likelihood == pytest.approx(2 * np.log(0.5))


def test_an_unbeaten_condition_has_a_finite_worth_and_is_named() -> None:
    result = plackett_luce(as_rankings(votes_of(["a"], ["b"], [1], ["P"])), "ab")
    assert result.unbeaten == "a never lost to any of the others"
    assert np.isfinite(result.strengths).all()


def test_true_worths_are_recovered_from_partial_rankings() -> None:
    whole = ranking_table(participants=20, segments=40)
    whole["ranking"] = whole.index // 3
    left_out = (whole["ranking"] % 3 == 0) & (whole["condition"] == "ours")
    for table in (whole, whole[~left_out]):
        result = plackett_luce(table, ("truth", "ours", "static"))

        assert result.strengths == pytest.approx([0.8, 0, -0.8], abs=0.2)
        assert result.strengths.sum() == pytest.approx(0, abs=1e-9)
        assert (result.errors > 0).all()
        assert (result.n, result.participants) == (800, 20)


def test_standard_errors_agree_with_logistic_regression() -> None:
    votes = made_votes()
    design = np.eye(4)[votes.left] - np.eye(4)[votes.right]
    fitted = Logit((votes.outcome > 0).astype(float), design[:, 1:]).fit(disp=False)
    covariance = cov_cluster_2groups(fitted, votes.participant, votes.segment)[0]
    covariance = covariance * (len(design) - 3) / (len(design) - 1)  # Its factor for few answers.
    turn = np.eye(4)[:, 1:] - 1 / 4

    result = bradley_terry(votes, left_effect=False)

    assert result.strengths == pytest.approx(turn @ fitted.params)
    errors = errors_of(result)
    assert errors.method == TWO_WAY
    # Theirs is CR1, which is close to CR2 if all have given the same number of answers.
    assert errors.errors == pytest.approx(
        np.sqrt(np.diagonal(turn @ covariance @ turn.T)), rel=5e-3
    )
    assert errors.differences[0, 1:] == pytest.approx(np.sqrt(np.diagonal(covariance)), rel=5e-3)
    two_way = errors.by_participant + errors.by_segment - errors.by_cell
    assert two_way == pytest.approx(turn @ covariance @ turn.T, rel=1e-6)


def test_a_larger_one_way_variance_replaces_the_two_way_one() -> None:
    votes = made_votes(taste=0.0, luck=0.0)
    errors = errors_of(bradley_terry(votes))
    assert errors.method == MIXED
    matrix = errors.by_participant
    own = np.diagonal(matrix)
    of_participants = own[:, None] + own - 2 * matrix
    assert (errors.differences**2 >= 0.999 * of_participants - 1e-12).all()


def test_with_one_segment_errors_are_clustered_by_participant() -> None:
    votes = made_votes()

    result = bradley_terry(replace(votes, segment=np.zeros_like(votes.left)))

    assert errors_of(result).method == ONE_SEGMENT
    assert errors_of(result).errors == pytest.approx(result.errors, rel=0.03)


@pytest.mark.parametrize(
    ("strengths", "ranks"),
    [
        ([0.0, 2.0, -2.0], ((2, 2), (1, 1), (3, 3))),
        # Significant alone at .034, but not among three tests.
        ([0.0, 0.3, -2.0], ((1, 2), (1, 2), (3, 3))),
        ([np.nan] * 3, ((1, 3),) * 3),
    ],
)
def test_indistinguishable_conditions_share_their_ranks(
    strengths: list[float], ranks: tuple[tuple[int, int], ...]
) -> None:
    values = np.array(strengths)
    # Each strength has an error of .1.
    p_values = 2 * stats.norm.sf(np.abs(values[:, None] - values) / np.sqrt(0.02))
    assert rank_intervals(values, p_values) == ranks


def test_the_omnibus_test_is_hotellings_if_only_participants_are_sampled() -> None:
    chance = np.random.default_rng(4)
    given = chance.normal(size=(15, 3)) + np.array([0.6, 0.0, 0.0])
    influences = (given - given.mean(axis=0)) / len(given)
    alone = np.zeros(15, int)
    errors = TwoWayErrors.of(influences, alone, np.arange(15), np.arange(15), alone)
    assert errors is not None

    result = omnibus(given.mean(axis=0), errors)

    turn = np.array([[-1, 1, 0], [-1, 0, 1]])
    means, spread = turn @ given.mean(axis=0), turn @ np.cov(given.T) @ turn.T
    squared = 15 * means @ np.linalg.solve(spread, means)
    assert (result.df, result.df_rest) == pytest.approx((2, 13))
    assert result.p_value == pytest.approx(stats.f.sf(squared * 13 / (14 * 2), 2, 13))


def test_too_few_segments_give_no_omnibus_test() -> None:
    votes = made_votes()
    result = bradley_terry(replace(votes, segment=votes.segment % 3))
    reason = omnibus(result.strengths, errors_of(result)).reason
    assert "too few for a joint test of 4 conditions" in reason


def test_the_prior_is_half_a_win_and_half_a_loss_against_the_average() -> None:
    votes = votes_of(["c"] * 9, ["a"] * 9, [1] * 9, [str(n) for n in range(9)])
    result = bradley_terry(votes, left_effect=False)
    # With strengths s and -s: 9 log F(2s) + 2 * (log F(s) + log F(-s)) / 2 is largest.
    tried = np.linspace(0, 6, 60_001)
    value = -9 * np.log1p(np.exp(-2 * tried)) - np.log1p(np.exp(-tried)) - np.log1p(np.exp(tried))
    assert result.strengths[0] == pytest.approx(tried[value.argmax()], abs=1e-3)
    assert result.log_likelihood == pytest.approx(-9 * np.log1p(np.exp(-2 * result.strengths[0])))
