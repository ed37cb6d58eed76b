from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from motion.segment import Segment
from studyapp.study.creation.study_file import new_study
from studyapp.study.settings.reading import parse_study
from studyapp.study.versioning import design_digest, operation_part


@pytest.mark.parametrize("stated", [True, False])
def test_whether_a_condition_is_generative_is_no_part_of_the_design(
    stated: bool, tmp_path: Path
) -> None:
    segments = (Segment(name="a", wav="a.wav", start=0, end=5, speaker="a", emotion="happiness"),)
    path = tmp_path / "study.toml"
    new_study(path, name="study")
    data = tomllib.loads(path.read_text("utf-8"))
    plain = parse_study(data, where=path)
    data["conditions"]["mismatched"]["generative"] = stated
    marked = parse_study(data, where=path)
    assert marked.conditions["mismatched"].generative is stated
    assert marked.conditions["rule_based"].generative is None
    assert design_digest(marked, segments, {}) == design_digest(plain, segments, {})
    assert operation_part(marked) == operation_part(plain)
