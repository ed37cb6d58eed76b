from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from benchmarks.validity.studies import Design, preferences, true_outcomes
from tools.worked_examples.amuse_study import TABLE_A5
from tools.worked_examples.page import worked_examples
from tools.worked_examples.rebuilt import counts_behind, rebuild
from tools.worked_examples.spread import Spread, with_spread

PAGE = Path(__file__).resolve().parents[3] / "docs" / "worked-examples.md"
PAPER = "papers/amuse.txt"


def test_the_docs_page_has_the_computed_numbers() -> None:
    assert PAGE.read_text("utf-8") == worked_examples(), "run 'make worked-examples'"


def test_the_table_matches_the_paper(shared_data: Path) -> None:
    text = (shared_data.parent / PAPER).read_text("utf-8")
    lines = text[text.index("Table A.5.") :].splitlines()[:10]
    for printed in {row.other for row in TABLE_A5}:
        (cells,) = (line.split("\t")[1:] for line in lines if line.startswith(f"{printed}\t"))
        rows = [row for row in TABLE_A5 if row.other == printed]
        assert list(map(int, cells)) == [n for row in rows for n in (row.ours, row.others)]


def test_the_sign_test_of_rebuilt_counts_is_the_exact_binomial_test() -> None:
    for row in rebuild():
        ours, others = row.nearest
        assert row.binomial_p == pytest.approx(stats.binomtest(ours, ours + others).pvalue)
        assert row.binomial_range[0] <= row.binomial_p <= row.binomial_range[1]


@pytest.mark.parametrize("total", [90, 528, 600])
@pytest.mark.parametrize("decimals", [0, 2])
def test_every_count_matches_its_printed_percentage(total: int, decimals: int) -> None:
    for count in range(total + 1):
        assert count in counts_behind(round(100 * count / total, decimals), total, decimals)


STUDIES = 600


@pytest.mark.parametrize(("participant_sd", "item_sd"), [(0.0, 0.0), (0.6, 0.45), (1.0, 0.8)])
def test_win_shares_of_simulated_studies_vary_as_much_as_stated(
    participant_sd: float, item_sd: float
) -> None:
    design = Design(
        participants=22, items=24, effect=0.4, participant_sd=participant_sd, item_sd=item_sd
    )
    chance = np.random.default_rng(5)
    shares = [preferences(design, chance).wins.mean() for _ in range(STUDIES)]
    wins, _, losses = true_outcomes(design)

    estimate = with_spread(
        wins,
        losses,
        participants=22,
        items=24,
        spread=Spread(participants=participant_sd, items=item_sd),
    )

    margin = stats.t.ppf(0.975, 21)
    # The standard deviation of 600 shares is known within 6% (two standard errors).
    assert np.std(shares) == pytest.approx((estimate.high - estimate.low) / (2 * margin), rel=0.09)
    assert np.mean(shares) == pytest.approx(estimate.win_share, abs=0.01)
