from __future__ import annotations

from collections.abc import Mapping

import pytest

from analysis.report.content import Section
from analysis.report.headline.ranking_tables import ordinal
from analysis.results.ranking import RankingResults
from analysis.results.report import TableReport
from tests.analysis.report.headline.reading import edges, named_picture, named_table, told


@pytest.fixture(scope="module")
def results(ranked: TableReport) -> RankingResults:
    assert isinstance(ranked.results, RankingResults)
    return ranked.results


@pytest.fixture(scope="module")
def section(sections: Mapping[str, tuple[Section, ...]]) -> Section:
    (found,) = sections["ranking"]
    return found


def test_parts_of_a_bar_are_as_wide_as_places_were_reached(
    results: RankingResults, section: Section
) -> None:
    picture = named_picture(section, "places")
    for row, one in enumerate(sorted(results.conditions, key=lambda c: c.mean_rank.estimate)):
        parts = edges(picture, [f"bar0-{row}-{place}" for place in range(3)])
        widths = [right - left for left, right in parts]
        assert [100 * w / sum(widths) for w in widths] == pytest.approx(
            list(one.rank_percent.values()), abs=0.05
        )


def test_mean_ranks_first_places_and_worths_stand_in_one_section(
    results: RankingResults, section: Section
) -> None:
    assert [picture.name for picture in section.pictures] == ["places", "worths"]
    for row, one in zip(named_table(section, "ranks").rows, results.conditions, strict=True):
        assert row[3].value == one.mean_rank.estimate
        assert row[6].value == one.first_share.estimate
    worths = results.plackett_luce["realism"]
    rows = named_table(section, "worths").rows
    assert {row[1].text: row[2].value for row in rows} == worths.worths  # type: ignore[union-attr]
    assert "rank " in told(named_picture(section, "worths"))


def test_places_are_counted_as_people_say_them() -> None:
    assert [ordinal(place) for place in (1, 2, 3, 4, 11, 12, 13, 21, 22)] == [
        *("1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "21st", "22nd")
    ]
