from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.results.heterogeneity import cells
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.multiple_testing import holm
from tests.analysis.results.made_tables import TABLES, report_of


def apart(folder: Path, table: pd.DataFrame, protocol: str) -> list[Any]:
    return list(report_of(table, protocol, folder).results.heterogeneity)


def with_emotions(table: pd.DataFrame) -> pd.DataFrame:
    """Six segments: four angry ones, two that are neither."""
    number = table["segment"].str[1:].astype(int)
    emotion = np.where(number < 4, "anger", "joy")
    return table.assign(emotion=emotion, speaker=np.where(number % 2, "ada", "bo"))


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
    assert {one.by for one in result} == {"emotion", "speaker", "segment"}
    for one in result:
        described = {level.level: level.descriptive for level in one.levels}
        if one.by == "emotion":
            assert described == {"anger": False, "joy": True}
        if one.by == "speaker":
            assert described == {"ada": True, "bo": True}
        if one.by == "segment":
            assert list(described) == [f"s{n}" for n in range(6)]
            assert all(described.values())
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


def test_levels_add_up_to_the_whole_study(tmp_path: Path) -> None:
    table = with_emotions(TABLES["pairwise"](participants=8))
    results: Any = report_of(table, "pairwise", tmp_path).results

    for whole in results.comparisons:
        for effect in results.heterogeneity:
            if (effect.a, effect.b, effect.question) == (whole.a, whole.b, whole.question):
                assert sum(level.n for level in effect.levels) == whole.n
                together = sum(level.n * level.estimate for level in effect.levels) / whole.n
                assert together == pytest.approx(whole.win_share.estimate)


def test_unpaired_ratings_have_no_difference(tmp_path: Path) -> None:
    table = with_emotions(TABLES["rating"](participants=6))
    lonely = table[~((table["condition"] == "ours") & (table["segment"] == "s0"))]

    result = apart(tmp_path, lonely, "rating")

    pair = next(
        one for one in result if one.by == "segment" and {one.a, one.b} == {"truth", "ours"}
    )
    assert [level.level for level in pair.levels] == [f"s{n}" for n in range(1, 6)]


def test_a_level_of_many_segments_is_tested_like_a_whole_study() -> None:
    chance = np.random.default_rng(2)
    people, items = np.repeat(np.arange(9), 12), np.tile(np.arange(12), 9)
    wins = chance.integers(0, 3, len(people)) / 2

    [first, second] = cells(
        wins, items // 6, ["anger", "joy"], people, items, null=0.5, limits=(0, 1)
    )

    own = items < 6
    assert (first.level, second.level) == ("anger", "joy")
    whole = clustered_mean(wins[own], people[own], items[own])
    assert vars(whole).items() <= vars(first).items()
    assert not first.descriptive
