from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from analysis.answers.participants import leave_out
from analysis.results.preferred_pairs import MOST_PAIRS, PreferredPair, preferred_pairs
from tests.analysis.results.made_tables import TABLES, pairwise_table, read_table


def pairs_of(rows: pd.DataFrame, protocol: str, folder: Path) -> tuple[PreferredPair, ...]:
    table = read_table(rows, protocol, folder)
    return preferred_pairs(table, leave_out(table, ()).analysed)


def test_for_two_conditions_the_segments_with_most_and_fewest_wins_are_kept(
    tmp_path: Path,
) -> None:
    rows = pd.DataFrame(
        [
            ("p1", "liked", "ours", "theirs", 1),
            ("p2", "liked", "theirs", "ours", 5),
            ("p1", "between", "ours", "theirs", 3),
            ("p2", "between", "ours", "theirs", 2),
            ("p1", "disliked", "ours", "theirs", 4),
            ("p2", "disliked", "theirs", "ours", 3),
        ],
        columns=["participant", "segment", "left", "right", "response"],
    ).assign(question="fit")

    result = pairs_of(rows, "pairwise", tmp_path)

    assert [(one.first, one.second, one.segment) for one in result] == [
        ("ours", "theirs", "liked"),
        ("ours", "theirs", "disliked"),
    ]
    assert [one.win_shares for one in result] == [{"fit": 1.0}, {"fit": 0.25}]
    assert [one.answers for one in result] == [{"fit": 2}, {"fit": 2}]


@pytest.mark.parametrize(
    ("protocol", "value", "given"), [("rating", "response", (4, 2)), ("ranking", "rank", (1, 2))]
)
def test_in_ratings_and_rankings_the_clip_placed_higher_wins(
    protocol: str, value: str, given: tuple[int, int], tmp_path: Path
) -> None:
    rows = pd.DataFrame(
        {
            "participant": "p1",
            "segment": "s1",
            "question": "realism",
            "condition": ["ours", "theirs"],
            value: given,
        }
    )

    (result,) = pairs_of(rows, protocol, tmp_path)

    assert (result.first, result.second, result.win_shares) == ("ours", "theirs", {"realism": 1.0})


def test_with_many_conditions_both_ends_of_the_first_questions_order_are_kept(
    tmp_path: Path,
) -> None:
    rows = pairwise_table(
        tuple("abcdef"), ("emotion", "fit"), participants=3, effects=(3, 2, 1, 0, -1, -2)
    )

    result = pairs_of(rows, "pairwise", tmp_path)

    shares = [pair.win_shares["emotion"] for pair in result]
    assert len(shares) == MOST_PAIRS
    assert shares == sorted(shares, reverse=True)
    assert shares[0] == 1.0
    assert shares[-1] < 0.5
    assert all(set(pair.win_shares) == {"emotion", "fit"} for pair in result)


def test_a_mismatch_task_compares_no_conditions(tmp_path: Path) -> None:
    assert pairs_of(TABLES["mismatch"](participants=4, segments=3), "mismatch", tmp_path) == ()
