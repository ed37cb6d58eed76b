import re

import pytest

from analysis.report import wording
from analysis.report.content import Section
from analysis.report.sections import preferences
from analysis.report.sections.preferences import pairwise_groups
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.report import TableReport
from tests.analysis.report.sections.conftest import Analyse, Reports, Sections
from tests.analysis.report.sections.reading import bar, named_picture, named_table, told, words
from tests.analysis.report.subjects import headline
from tests.analysis.results.made_tables import mismatch_table, pairwise_table


@pytest.fixture
def section(sections: Sections) -> Section:
    """Return the section of all pairs."""
    (section,) = sections("all pairs")
    return section


def results(report: TableReport) -> PairwiseResults:
    assert isinstance(report.results, PairwiseResults)
    return report.results


def test_the_text_alternative_has_every_number(reports: Reports, section: Section) -> None:
    picture = named_picture(section, "preferences")
    for comparison in results(reports("all pairs")).comparisons:
        a, b = comparison.a, comparison.b
        levels = (f"clearly {a}", f"slightly {a}", "no difference")
        for level, count in zip(levels, comparison.counts.values(), strict=False):
            assert f"{level}: {count} of {comparison.n}" in told(picture)
        assert f"{a} against {b}:" in told(picture)
        assert f"win share {wording.share(comparison.win_share.estimate)}" in told(picture)


def test_bars_are_proportional_and_centred_on_no_difference(
    reports: Reports, section: Section
) -> None:
    (group,) = pairwise_groups(results(reports("all pairs")), None)
    picture = named_picture(section, "preferences")
    for row, label in enumerate(group.labels):
        found = next(r for r in group.rows if r.label == label and r.result.question == "emotion")
        parts = bar(picture, row)
        assert [width for _, width in parts] == pytest.approx(found.percentages)
        assert parts[2][0] + parts[2][1] / 2 == pytest.approx(0)


def test_emotion_comes_first_and_rows_are_sorted_by_its_win_share(
    reports: Reports, section: Section
) -> None:
    said = words(named_picture(section, "preferences"))
    assert said.index("Emotion") < said.index("Rhythm")
    shares = [
        wording.share(one.win_share.estimate)
        for one in sorted(
            (c for c in results(reports("all pairs")).comparisons if c.question == "emotion"),
            key=lambda one: -one.win_share.estimate,
        )
    ]
    assert [text for text in said if text in shares][: len(shares)] == shares


def test_comparisons_are_oriented_to_their_common_condition(
    reports: Reports, sections: Sections
) -> None:
    found = results(reports("against one"))
    (group,) = pairwise_groups(found, None)
    assert group.first == "static"
    turned = 0
    for row in group.rows:
        one = next(c for c in found.comparisons if row.label in {c.a, c.b})
        assert "static" in {one.a, one.b}
        if one.a == "static":
            assert row.levels == tuple(one.counts.values())
            continue
        turned += 1
        assert row.levels == tuple(one.counts.values())[::-1]
        assert row.result.win_share.low == pytest.approx(1 - one.win_share.high)
    assert 0 < turned < len(group.rows)
    (section,) = sections("against one")
    assert [picture.name for picture in section.pictures] == ["preferences"]
    (of_all,) = pairwise_groups(results(reports("all pairs")), "ours")
    assert of_all.first == "the first"


def test_tests_beside_those_that_the_report_decides_by_are_called_secondary(
    analyse: Analyse, sections: Sections
) -> None:
    conditions = ("truth", "ours", "other", "static")
    effects = (1.0, 0.6, 0.3, 0.0)
    table = pairwise_table(conditions, effects=effects, participants=5, segments=4)
    for (shown,), decisive in (
        (sections("all pairs"), "win-shares"),
        (headline(analyse("pairwise", table)), "contrasts"),
    ):
        for name in ("win-shares", "contrasts"):
            notes = " ".join(named_table(shown, name).notes)
            assert ("These tests are secondary" in notes) == (name != decisive)


def test_table_a5_sums_and_published_p_values_match_the_results(
    reports: Reports, sections: Sections
) -> None:
    (section,) = sections("against one")
    table = named_table(section, "preferences")
    assert table.groups == (("", 1), ("Emotion", 4))
    as_published = named_table(section, "as-published")
    assert any("resemble each other" in note for note in as_published.notes)
    for row in table.rows:
        one = next(
            c for c in results(reports("against one")).comparisons if row[0].text in {c.a, c.b}
        )
        ours, other = ("a", "b") if one.a == "static" else ("b", "a")
        assert [cell.value for cell in row[1:]] == pytest.approx(
            [one.share[ours], one.share[other], one.share["equal"], one.n]
        )
        assert row[1].best == (one.share[ours] > one.share[other])
        assert row[2].best == (one.share[other] > one.share[ours])
        published = one.as_published
        row = next(r for r in as_published.rows if r[1].text == row[0].text)
        assert [c.value for c in row[-2:]] == [published.binomial_p, published.wilcoxon_p]


def test_many_comparisons_are_shown_as_a_matrix(
    reports: Reports, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(preferences, "MOST_BARS", 2)
    (section,) = headline(reports("all pairs"))
    assert [picture.name for picture in section.pictures] == ["win-share-matrix", "strengths"]
    said = re.split("[.;] ", told(section.pictures[0]))
    for one in results(reports("all pairs")).comparisons:
        share = one.win_share.estimate
        assert any(
            text.startswith(f"{one.a} against {one.b}: {wording.share(share)}") for text in said
        )
        assert any(
            text.startswith(f"{one.b} against {one.a}: {wording.share(1 - share)}") for text in said
        )


def test_own_speech_is_on_the_left_for_every_condition(
    reports: Reports, sections: Sections
) -> None:
    mismatch = reports("mismatch").results
    assert isinstance(mismatch, MismatchResults)
    (section,) = sections("mismatch")
    picture = named_picture(section, "own-speech")
    for one in mismatch.conditions:
        assert f"clearly own speech: {one.counts['own_strong']} of {one.n}" in told(picture)
    assert any(text.startswith("truth") for text in words(picture))
    table = named_table(section, "own-speech")
    best = {row[0].text: row[1].value for row in table.rows}
    assert best == pytest.approx({c.condition: c.share["own"] for c in mismatch.conditions})


def test_without_degrees_of_preference_none_are_named(analyse: Analyse) -> None:
    table = mismatch_table()
    (section,) = headline(analyse("mismatch", table.assign(response=table["response"].clip(2, 4))))
    assert not [text for text in words(named_picture(section, "own-speech")) if "clearly" in text]
    said = told(named_picture(section, "own-speech"))
    assert "slightly" not in said and ": own speech: " in said
    assert "clear and slight" not in named_table(section, "own-speech").caption
