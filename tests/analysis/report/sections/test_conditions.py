from dataclasses import replace

import pytest

from analysis.report.sections.conditions import distribution_pictures
from analysis.results.conditions import RankingResults, RatingResults
from tests.analysis.report.sections.conftest import Analyse, Reports, Sections
from tests.analysis.report.sections.reading import (
    SCALE,
    bar,
    named_picture,
    named_table,
    told,
    words,
)
from tests.analysis.report.subjects import headline
from tests.analysis.results.made_tables import rating_table


@pytest.fixture(scope="module")
def results(reports: Reports) -> RatingResults:
    found = reports("rating").results
    assert isinstance(found, RatingResults)
    return found


def test_sets_are_kept_apart(sections: Sections) -> None:
    assert [section.heading for section in sections("rating")] == [
        "Set 1: how the conditions were rated",
        "Set 2: how the conditions were rated",
    ]
    first, second = ({row[0].text for row in s.tables[0].rows} for s in sections("rating"))
    assert first == {"truth", "ours", "static"}
    assert second == {"truth", "late"}
    names = [p.name for s in sections("rating") for p in s.pictures]
    assert len(names) == len(set(names))


def test_bars_are_the_shares_of_scores_and_places(
    results: RatingResults, ranking_results: RankingResults, sections: Sections
) -> None:
    said = told(named_picture(sections("rating")[0], "ratings-set-1"))
    for rated in (c for c in results.conditions if c.set == "1"):
        assert f"{rated.condition}: score 1: {rated.counts[1]} of {rated.n} ratings" in said
    picture = named_picture(sections("ranking")[0], "places")
    best = min(ranking_results.conditions, key=lambda c: c.mean_rank.estimate)
    assert [width for _, width in bar(picture, 0)] == pytest.approx([*best.rank_percent.values()])


def test_cumulative_curves_are_the_shares_that_reach_a_score(
    results: RatingResults, sections: Sections
) -> None:
    said = told(named_picture(sections("rating")[0], "cumulative-set-1"))
    for one in (c for c in results.conditions if c.set == "1"):
        assert f"{one.condition}: 100% at least 1" in said
        assert f"{one.at_least[3]:.0f}% at least 3" in said


def test_the_best_mean_is_bold_and_the_second_best_underlined(sections: Sections) -> None:
    rows = named_table(sections("rating")[0], "scores-set-1").rows
    means = {row[0].text: row[1] for row in rows}
    assert means["truth"].best
    assert means["ours"].second
    assert not means["static"].best
    assert not means["static"].second


def test_contrasts_start_with_paired_differences_corrected_by_holm(
    results: RatingResults, sections: Sections
) -> None:
    rows = named_table(sections("rating")[0], "contrasts-set-1").rows
    found = [c for c in results.contrasts if c.set == "1"]
    assert [[row[4].value, row[7].value] for row in rows] == [
        [c.difference.estimate, c.difference.p_holm] for c in found
    ]
    assert named_picture(sections("rating")[0], "contrasts-set-1")


def test_a_table_says_which_differences_are_not_of_pairs_and_which_intervals_of_one_segment(
    analyse: Analyse,
) -> None:
    table = rating_table(participants=8, segments=4)
    unpaired = table[(table["condition"] == "ours") == (table["participant"] < "p04")]
    (of_unpaired,), (of_one_segment,) = (
        headline(analyse("rating", rated)) for rated in (unpaired, table[table["segment"] == "s0"])
    )
    for section, name, note in (
        (of_unpaired, "contrasts", "difference of all ratings, since few participants"),
        (of_one_segment, "means", "interval clustered by participant; of this"),
        (of_one_segment, "contrasts", "clustered by participant; of this segment"),
    ):
        assert note in " ".join(named_table(section, name).notes)


def test_score_labels_are_in_the_legend_or_if_they_differ_in_the_caption(
    results: RatingResults, sections: Sections
) -> None:
    legend = " ".join(words(named_picture(sections("rating")[0], "ratings-set-1")))
    assert [label for label in SCALE if label not in legend] == []
    conditions = [c for c in results.conditions if c.set == "1"]
    twice = [*conditions, *(replace(c, question="sync") for c in conditions)]
    (picture,) = distribution_pictures(twice, {"match": SCALE, "sync": tuple("abcde")})
    assert "Sync: 1 a, 2 b, 3 c, 4 d, 5 e." in picture.caption
    assert "1 (worst)" in words(picture)


@pytest.fixture(scope="module")
def ranking_results(reports: Reports) -> RankingResults:
    found = reports("ranking").results
    assert isinstance(found, RankingResults)
    return found


def test_mean_ranks_first_places_and_worths_share_a_section(
    ranking_results: RankingResults, sections: Sections
) -> None:
    (ranking_section,) = sections("ranking")
    assert [picture.name for picture in ranking_section.pictures] == ["places", "worths"]
    for row, one in zip(
        named_table(ranking_section, "ranks").rows, ranking_results.conditions, strict=True
    ):
        assert row[3].value == one.mean_rank.estimate
        assert row[6].value == one.first_share.estimate
    worths = ranking_results.plackett_luce.of_set(None)["realism"]
    rows = named_table(ranking_section, "worths").rows
    assert {row[1].text: row[2].value for row in rows} == {
        one.condition: one.estimate for one in worths.conditions
    }
    assert "rank " in told(named_picture(ranking_section, "worths"))
