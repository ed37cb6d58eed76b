from __future__ import annotations

from analysis.report.findings import find
from analysis.report.preference_sections import win_share_section
from analysis.report.scope_sections import generality_section, methods_section
from analysis.responses import responses_frame


def words(section):
    return " ".join(section.bullets)


def test_without_answers_nothing_is_said_about_tests_or_intervals(simulated_study):
    inputs = simulated_study().inputs(origin="none", responses=responses_frame([]))
    findings = find(inputs)
    said = words(generality_section(inputs, findings)) + words(methods_section(inputs, findings))
    assert "participants will be asked" in said
    assert "24 segments" in said
    for word in ("interval", "were asked", "p below", "complete with"):
        assert word not in said


def test_one_speaker_is_said_to_tell_nothing_about_others(simulated_study):
    study = simulated_study(participants=4, segments=4)
    inputs = study.inputs(segments=(study.segment(0), study.segment(2)))
    said = words(generality_section(inputs, find(inputs)))
    assert "by 1 speaker (wayne)" in said
    assert "One speaker tells nothing about other speakers." in said
    two = study.inputs()
    assert "tells nothing about other speakers" not in words(generality_section(two, find(two)))


def test_questions_stand_in_one_order_everywhere(simulated_study):
    inputs = simulated_study(participants=4, segments=4).inputs()
    findings = find(inputs)
    shares, sides = win_share_section(inputs, findings).tables
    order = ["emotion", "synchronisation"]
    assert list(dict.fromkeys(row[0].text for row in shares.rows)) == order
    assert [row[0].text for row in sides.rows] == order
    assert methods_section(inputs, findings).bullets[0].startswith("Emotion: ")


def test_raters_of_a_rehearsal_are_not_called_people(simulated_study):
    inputs = simulated_study(participants=4, segments=4).inputs(origin="rehearsal")
    header = win_share_section(inputs, find(inputs)).tables[0].header
    assert header.count("simulated raters × segments") == 2
