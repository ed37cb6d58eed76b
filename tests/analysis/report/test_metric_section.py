from __future__ import annotations

import math

from analysis.metrics.conditions import ConditionScore, StudyMetrics
from analysis.report import KnownShare
from analysis.report.findings import find
from analysis.report.metric_section import metrics_section
from analysis.report.truth_section import truth_section


def score(condition, name, value, spread=math.nan, reason="", unit="m/s³"):
    return ConditionScore(
        condition=condition,
        name=name,
        unit=unit,
        value=value,
        spread=spread,
        scored=0 if reason else 2,
        clips=2,
        settings={"joints": "left_wrist"},
        reason=reason,
    )


def rows(section):
    return {row[0].text: [cell.text for cell in row[1:]] for row in section.tables[0].rows}


def with_metrics(inputs, scores):
    findings = find(inputs)
    return type(findings)(
        **(vars(findings) | {"metrics": StudyMetrics(frame_rate=30, clips=(), conditions=scores)})
    )


def test_answers_stand_above_the_metrics_per_condition(simulated_study):
    inputs = simulated_study(participants=6, segments=8).inputs()
    scores = tuple(
        score(condition, "jerk (hands)", value, 0.13)
        for condition, value in (("static", 0.0), ("rule_based", 1.234), ("broken", 99.0))
    )
    section = metrics_section(inputs, with_metrics(inputs, scores))
    assert section.tables[0].header == ("measure", "rule based", "static", "broken")
    found = rows(section)
    human = found["preferred to rule based: emotion"]
    assert human[0] == "reference"
    assert human[2] == "catch trials only"
    assert found["jerk (hands), m/s³"] == ["1.23 ± 0.13", "0 ± 0.13", "99.00 ± 0.13"]


def test_the_share_of_a_condition_mirrors_the_share_of_the_reference(simulated_study):
    inputs = simulated_study(participants=10, segments=8).inputs()
    findings = with_metrics(inputs, (score("static", "jerk (hands)", 1.0),))
    reference = next(
        p.win_share for p in findings.preferences if (p.other, p.question) == ("static", "emotion")
    )
    text = rows(metrics_section(inputs, findings))["preferred to rule based: emotion"][0]
    assert text.startswith(f"{1 - reference.estimate:.2f}"[1:])
    assert f"[{1 - reference.high:.2f}".replace("0.", ".") in text


def test_a_missing_score_is_a_dash_with_its_reason_below(simulated_study):
    inputs = simulated_study(participants=4, segments=4).inputs()
    scores = (score("static", "jerk (hands)", math.nan, reason="too short (2 of 2 clips)"),)
    table = metrics_section(inputs, with_metrics(inputs, scores)).tables[0]
    assert table.rows[-1][1].text == "–"
    assert table.notes[-1] == "static, jerk (hands): too short (2 of 2 clips)."
    assert table.notes[0] == "jerk (hands) – joints: left wrist."


def test_raw_beat_alignment_is_left_to_the_data_file(simulated_study):
    inputs = simulated_study(participants=4, segments=4).inputs()
    scores = tuple(
        score("static", name, 0.5, unit="")
        for name in (
            "beat alignment (amuse)",
            "beat alignment by chance (amuse)",
            "beat alignment above chance (amuse)",
        )
    )
    found = rows(metrics_section(inputs, with_metrics(inputs, scores)))
    assert [name for name in found if "beat" in name] == ["beat alignment above chance (amuse)"]


def test_a_truth_outside_its_interval_is_called_outside(simulated_study):
    study = simulated_study(participants=12, segments=12, effects={"static": 1.6})
    truth = {("rule_based_vs_static", "emotion"): KnownShare(share=0.05, on_these_segments=0.05)}
    inputs = study.inputs(origin="rehearsal", truth=truth)
    section = truth_section(inputs, find(inputs))
    assert [row[4].text for row in section.tables[0].rows] == ["outside"]
    assert "0 of 1 intervals" in section.paragraphs[0]
