from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.answers.participants import leave_out
from analysis.results.heterogeneity import MOST_PAIRS, PreferredPair, preferred_pairs
from analysis.stats.multiple_testing import holm
from tests.analysis.results.made_tables import (
    TABLES,
    crossed,
    pairwise_table,
    read_table,
    report_of,
)


def apart(folder: Path, table: pd.DataFrame, protocol: str) -> list[Any]:
    return list(report_of(table, protocol, folder).results.heterogeneity)


def with_emotions(table: pd.DataFrame) -> pd.DataFrame:
    """Six segments: four angry ones, two that are neither."""
    number = table["segment"].str[1:].astype(int)
    emotion = np.where(number < 4, "anger", "joy")
    return table.assign(emotion=emotion, speaker=np.where(number % 2, "ada", "bo"))


LEVELS = {
    "emotion": [("anger", False), ("joy", True)],
    "speaker": [("ada", True), ("bo", True)],
    "segment": [(f"s{number}", True) for number in range(6)],
}
"""The levels of a table `with_emotions`, and whether they are only described."""


@pytest.mark.parametrize(
    ("protocol", "measure"),
    [
        ("pairwise", "win_share"),
        ("mismatch", "win_share"),
        ("rating", "difference"),
        ("ranking", "mean_rank"),
    ],
)
def test_every_protocol_is_split_into_levels(protocol: str, measure: str, tmp_path: Path) -> None:
    result = apart(tmp_path, with_emotions(TABLES[protocol](participants=8)), protocol)

    assert {one.measure for one in result} == {measure}
    assert {one.by for one in result} == LEVELS.keys()
    for one in result:
        assert [(level.level, level.descriptive) for level in one.levels] == LEVELS[one.by]
        for level in one.levels:
            assert bool(level.remark) == level.descriptive
            assert np.isnan(level.p_value) == level.descriptive
    assert [one.test.p_holm for one in result] == pytest.approx(
        holm([one.test.p_value for one in result]), nan_ok=True
    )
    tested = [w for one in result for w in one.levels if not w.descriptive]
    assert [w.p_holm for w in tested] == pytest.approx(
        holm([w.p_value for w in tested]), nan_ok=True
    )


def test_a_level_is_analysed_like_a_study_of_it_alone(tmp_path: Path) -> None:
    table = with_emotions(TABLES["pairwise"](participants=8))
    results: Any = report_of(table, "pairwise", tmp_path).results
    alone: Any = report_of(table[table["emotion"] == "anger"], "pairwise", tmp_path).results

    for effect in (effect for effect in results.heterogeneity if effect.by == "emotion"):
        angry, joyful = effect.levels
        [whole, part] = (
            next(c for c in each.comparisons if (c.a, c.b) == (effect.a, effect.b))
            for each in (results, alone)
        )
        assert vars(part.win_share).items() <= vars(angry).items()
        assert angry.n + joyful.n == whole.n


def test_unpaired_ratings_have_no_difference(tmp_path: Path) -> None:
    table = with_emotions(TABLES["rating"](participants=6))
    lonely = table[~((table["condition"] == "ours") & (table["segment"] == "s0"))]

    pairs = {(one.by, one.a, one.b): one for one in apart(tmp_path, lonely, "rating")}

    levels = pairs["segment", "truth", "ours"].levels
    assert [level.level for level in levels] == [f"s{n}" for n in range(1, 6)]


def pairs_of(rows: pd.DataFrame, protocol: str, folder: Path) -> tuple[PreferredPair, ...]:
    table = read_table(rows, protocol, folder)
    return preferred_pairs(table, leave_out(table, ()).analysed)


def test_for_two_conditions_the_segments_with_most_and_fewest_wins_are_kept(tmp_path: Path) -> None:
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
    rows = crossed(1, 1, condition=["ours", "theirs"])

    (result,) = pairs_of(rows.assign(question="realism", **{value: given}), protocol, tmp_path)

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
