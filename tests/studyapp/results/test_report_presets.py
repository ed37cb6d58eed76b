from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.results.report_subject import report_presets
from studyapp.study.creation.study_file import new_study


@pytest.mark.parametrize(
    ("template", "measured"),
    [
        ("pairwise", ("report", "amuse")),
        ("mismatch", ("report", "genea")),
        ("three-systems", ("report", "amuse", "diffsheg", "s2ue")),
    ],
)
def test_a_report_measures_what_the_papers_do_whose_protocol_and_systems_a_study_has(
    tmp_path: Path, template: str, measured: tuple[str, ...]
) -> None:
    study = new_study(tmp_path / "study.toml", template=template, name="study")
    assert report_presets(study) == measured
