"""How often the planned participants will judge each segment."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from studyapp.preflight.design_checks import balance_findings
from studyapp.preflight.material import Material
from studyapp.study.folder import StudyFolder
from tests.support.studies.made_study import make_segments, make_study


@pytest.mark.parametrize(
    ("emotions", "changes", "balance", "unused"),
    [
        (["neutral", "anger"] * 2, {}, "50 planned participants judge each segment 50", ""),
        (["neutral"] * 3, {"comparisons": "adaptive"}, "chosen as answers arrive", ""),
        (["neutral"] * 99, {"trials": 1, "practice": 0}, "1 to 2 times", "segment-4 and 50 more"),
    ],
)
def test_judgements_of_segments_are_counted(
    emotions: list[str], changes: dict[str, Any], balance: str, unused: str
) -> None:
    material = Material(
        folder=StudyFolder(Path()),
        study=make_study(**changes),
        segments=make_segments(emotions),
        media=None,
    )

    findings = {finding.name: finding.what for finding in balance_findings(material)}

    assert balance in findings["balance"]
    assert ("segments-unused" in findings) == bool(unused)
    assert unused in findings.get("segments-unused", "")
