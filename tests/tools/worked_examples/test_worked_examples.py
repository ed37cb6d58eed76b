from pathlib import Path

import pytest
from scipy import stats

from tools.worked_examples.amuse_study import CLAIMS, EMOTION, TABLE_A5
from tools.worked_examples.page import worked_examples
from tools.worked_examples.rebuilt import Rebuilt, rebuild, supported

PAGE = Path(__file__).resolve().parents[3] / "docs" / "worked-examples.md"
PAPER = "papers/amuse.txt"


@pytest.fixture(scope="module")
def rebuilt() -> tuple[Rebuilt, ...]:
    return rebuild()


def test_the_page_in_the_docs_holds_the_numbers_that_are_computed() -> None:
    assert PAGE.read_text("utf-8") == worked_examples(), "run 'make worked-examples'"


def test_the_table_is_the_one_in_the_paper(shared_data: Path) -> None:
    text = (shared_data.parent / PAPER).read_text("utf-8")
    lines = text[text.index("Table A.5.") :].splitlines()[:10]
    for printed in {row.other for row in TABLE_A5}:
        (cells,) = (line.split("\t")[1:] for line in lines if line.startswith(f"{printed}\t"))
        rows = [row for row in TABLE_A5 if row.other == printed]
        assert list(map(int, cells)) == [n for row in rows for n in (row.ours, row.others)]


def test_rebuilt_counts_add_up_to_the_answers(rebuilt: tuple[Rebuilt, ...]) -> None:
    for row in rebuilt:
        assert sum(row.nearest) <= row.printed.answers
        assert row.nearest[0] in row.ours
        assert row.nearest[1] in row.others


def test_the_sign_test_of_rebuilt_counts_is_the_exact_binomial_one(
    rebuilt: tuple[Rebuilt, ...],
) -> None:
    for row in rebuilt:
        ours, others = row.nearest
        assert row.binomial_p == pytest.approx(stats.binomtest(ours, ours + others).pvalue)
        assert row.binomial_range[0] <= row.binomial_p <= row.binomial_range[1]


def test_amuse_is_not_shown_to_express_emotions_better_than_every_method(
    rebuilt: tuple[Rebuilt, ...],
) -> None:
    unsupported = {
        row.printed.other
        for row in rebuilt
        if row.printed.criterion == EMOTION and row.binomial_range[0] > 0.05
    }
    assert unsupported == {"TalkSHOW-BEAT", "Habibie et al."}


def test_a_claim_is_supported_only_in_the_direction_it_names(rebuilt: tuple[Rebuilt, ...]) -> None:
    emotion, synchronisation, gap, _ = (supported(claim, rebuilt) for claim in CLAIMS)

    assert (emotion.naive, emotion.tests) == (1, 3)
    assert synchronisation.shared == (3, 3, 3, 3)
    assert gap.naive == 1
    assert gap.shared[-1] == 0
