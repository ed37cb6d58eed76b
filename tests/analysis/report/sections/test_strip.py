from __future__ import annotations

from analysis.report.sections.strip import strip_section
from analysis.report.subject import Excerpt, Still, Subject


def subject(*conditions: str, **settings: object) -> Subject:
    stills = tuple(
        Still(condition=name, segment="s1", seconds=seconds, word="", image="data:image/webp;x")
        for name in conditions
        for seconds in (0.4, 1.25)
    )
    return Subject(
        title="study",
        origin="participants",
        protocol="rating",
        conditions=("ours", "theirs"),
        questions={},
        excerpts={"s1": Excerpt(transcript="Put them into <detention>.")},
        stills=stills,
        **settings,
    )


def test_each_condition_is_a_row_and_each_moment_a_column_with_words_for_every_picture():
    section = strip_section(subject("ours", "theirs"))
    assert section is not None
    (strip,) = section.pictures
    assert strip.svg.count("<img ") == 4
    assert 'alt="theirs after 1.2 seconds"' in strip.svg
    assert '<th scope="col">0.4 s</th>' in strip.svg
    assert '<th scope="row">ours</th>' in strip.svg
    assert "“Put them into <detention>.”" in section.paragraphs[0]


def test_a_condition_without_video_is_named():
    section = strip_section(subject("ours"))
    assert section is not None
    assert section.paragraphs[1] == (
        "There is no video of this segment, or none that can be read, of theirs."
    )


def test_where_there_are_none_the_reason_stands_in_their_place():
    section = strip_section(subject(no_stills="There are no videos yet."))
    assert section is not None
    assert section.paragraphs == ("There are no videos yet.",)


def test_a_table_of_answers_has_no_such_section():
    assert strip_section(subject()) is None


def test_names_cannot_become_markup():
    section = strip_section(subject("<b>ours</b>"))
    assert section is not None
    assert "<b>" not in section.pictures[0].svg
