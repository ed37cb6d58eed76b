import numpy as np
import pytest

from analysis.results.against_people.drawn_preferences import drawn_preferences
from analysis.results.against_people.tallies import tallies
from analysis.stats.two_way_bootstrap import bootstrap_means, cells_of
from tests.analysis.results.against_people.simulated_studies import AgreeingStudy


@pytest.fixture
def answers():
    return AgreeingStudy(conditions=3).drawn(np.random.default_rng(1))[0]


def test_estimates_are_the_means(answers):
    found = drawn_preferences(tallies("rating", answers), resamples=10, seed=0)
    means = answers.groupby("condition", observed=True)["value"].mean()
    assert found.estimates == pytest.approx(means.to_numpy())


def test_resamples_are_those_of_the_two_way_bootstrap(answers):
    one = answers[answers["condition"] == "c01"]
    cells = cells_of(
        one["value"].to_numpy(), one["participant"].to_numpy(), one["segment"].to_numpy()
    )
    expected = bootstrap_means(cells, resamples=500, seed=4)[:, 0]
    found = drawn_preferences(tallies("rating", answers), resamples=500, seed=4)
    assert found.draws[:, 1] == pytest.approx(expected)
    assert found.segments.sum(axis=1) == pytest.approx(12)


def test_one_seed_gives_one_result(answers):
    first, again = (
        drawn_preferences(tallies("rating", answers), resamples=50, seed=2) for _ in range(2)
    )
    assert np.array_equal(first.draws, again.draws)
