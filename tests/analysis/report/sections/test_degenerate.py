from collections.abc import Callable

import pandas as pd
import pytest

from analysis.report.content import Section
from analysis.report.sections.heterogeneity import heterogeneity_section
from tests.analysis.report.sections.conftest import Analyse, Sections
from tests.analysis.report.sections.reading import check_texts, drawn, named_picture, present, told
from tests.analysis.report.subjects import headline, subject_of
from tests.analysis.results.made_tables import TABLES, one_answer_everywhere, pairwise_table

PROTOCOLS = tuple(TABLES)


def of_one(table: pd.DataFrame) -> pd.DataFrame:
    return table[table["participant"] == "p00"]


CASES: dict[str, tuple[Callable[[pd.DataFrame], pd.DataFrame], str]] = {
    "one participant": (of_one, "Only one participant's answers"),
    "equal answers": (one_answer_everywhere, "nothing to test"),
    "everybody excluded": (lambda table: table.assign(excluded=True), "No answer is left"),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_sentence_replaces_an_empty_figure(protocol: str, case: str, analyse: Analyse) -> None:
    change, reason = CASES[case]
    found = headline(analyse(protocol, change(TABLES[protocol](participants=3, segments=3))))
    assert found or case == "everybody excluded"
    for section in found:
        assert reason in section.paragraphs[0]
        assert not section.pictures
        assert section.tables[0].rows


def test_a_comparison_without_analysed_answers_says_so_among_the_others(analyse: Analyse) -> None:
    table = pairwise_table(participants=4, segments=3)
    lost = table["participant"] == "p00"
    shown = lost | (table["left"] == "ours") | (table["right"] == "ours")
    table = table[shown].assign(excluded=lost)
    (section,) = headline(analyse("pairwise", table))
    picture = named_picture(section, "preferences")
    assert "no answers" in drawn(picture).get_text()
    assert "other against static: no answers" in told(picture)


@pytest.mark.parametrize("name", ["all pairs", "against one", "rating", "ranking", "mismatch"])
def test_no_cell_or_note_says_nan(name: str, analyse: Analyse, sections: Sections) -> None:
    check_texts(sections(name))
    if name in PROTOCOLS:
        check_texts(headline(analyse(name, TABLES[name](participants=1, segments=3))))


def test_effects_are_split_by_emotion_and_few_segments_are_descriptive(analyse: Analyse) -> None:
    table = pairwise_table(("ours", "other"), effects=(1, 0), participants=4, segments=6)

    def apart(answers: pd.DataFrame) -> Section:
        report = analyse("pairwise", answers)
        return present(heterogeneity_section(report, subject_of(report)))

    number = table["segment"].str[1:].astype(int)
    table["emotion"] = number.map(lambda k: "joy" if k % 2 else "anger")
    section = apart(table)
    assert [picture.name for picture in section.pictures] == ["by-emotion", "by-segment"]
    assert any("Hollow marks are descriptive" in text for text in section.paragraphs)
    said = drawn(section.pictures[0]).get_text()
    assert "all emotions" in said
    assert said.index("anger") < said.index("joy")
    (tests,) = section.tables
    assert [row[2].text for row in tests.rows] == ["emotion", "segment"]
    assert not tests.secondary
    once = apart(table.assign(emotion=table["segment"] + " emotion"))
    assert [picture.name for picture in once.pictures] == ["by-segment"]
    assert (
        "Each emotion has one segment, so its estimate is that of the segment." in once.paragraphs
    )
    alone = analyse("pairwise", of_one(table))
    assert heterogeneity_section(alone, subject_of(alone)) is None
    untested = apart(one_answer_everywhere(table))
    assert untested.tables[0].secondary == "No test could be run"
    assert any("no test" in note for note in untested.tables[0].notes)
