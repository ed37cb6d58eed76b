from __future__ import annotations

import numpy as np
import pytest

from analysis.report import ReportInputs
from analysis.report.findings import find
from analysis.report.flow_section import flow_section
from motion.clip import MotionClip
from motion.formats import write_clip


def test_excluded_study_sessions_enter_nothing_but_the_estimates_of_everyone(by_hand):
    findings = find(by_hand)
    assert findings.exclusion.sessions_analysed == 3
    for found in (findings.preferences, findings.emotions):
        assert [p.win_share.answers for p in found] == [6]
    assert [bias.left_share.answers for bias in findings.side_bias] == [6]
    assert {share.answers for share in findings.segments} == {3}
    assert [p.win_share.answers for p in findings.everyone] == [8]


def test_attention_checks_exclude_only_where_the_study_has_them(by_hand):
    checked = ReportInputs(**(vars(by_hand) | {"max_failed_attention": 0}))

    rules = [[o.rule for o in find(inputs).exclusion.outcomes] for inputs in (by_hand, checked)]

    assert [len(names) for names in rules] == [2, 3]
    assert rules[1][-1] == "failed attention checks"
    words = " ".join(flow_section(checked, find(checked)).paragraphs)
    assert "ask for one certain answer" in words


def test_metrics_look_at_the_motion_as_the_videos_show_it(by_hand, tmp_path):
    poses = np.zeros((60, 55, 3))
    poses[:, 0, 1] = np.sin(np.arange(60) / 5)
    path = tmp_path / "a.npz"
    write_clip(path, MotionClip(poses=poses, trans=np.zeros((60, 3)), frame_rate=30))

    def deviation(frozen):
        changes = {"clips": {"ours": {"a": path}}, "frozen": frozen}
        metrics = find(ReportInputs(**(vars(by_hand) | changes))).metrics
        return next(s.value for s in metrics.conditions if "L1div" in s.name)

    assert deviation(()) > 0.1
    assert deviation(("root",)) == pytest.approx(0, abs=1e-9)
