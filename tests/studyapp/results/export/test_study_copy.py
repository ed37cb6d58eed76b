from __future__ import annotations

import re
from importlib import metadata
from pathlib import Path

import pytest

from studyapp.results.export.about_folder import environment
from studyapp.results.export.study_copy import copy_study
from studyapp.study.folder import StudyFolder

LICENSED = '\n[video]\nbody = "licensed/smplx.npz"\nexpression_matrix = "{matrix}"\n'

MATERIAL = (
    "motion/rule_based/take-0.npz",
    "motion/broken/take-1.npz",
    "evaluators/emotion.safetensors",
    "matrix.npy",
)
"""What metrics are measured from, beside the speech."""

ELSE = ("responses.db", "pseudonyms.key", "report/results.json", "motion/unused/take-0.npz")


@pytest.fixture
def folder(tiny_study: Path) -> StudyFolder:
    for name in (*MATERIAL, *ELSE, "licensed/smplx.npz"):
        file = tiny_study / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(name.encode())
    return StudyFolder(tiny_study)


def copied(folder: StudyFolder, to: Path, matrix: str, *, videos: bool = False) -> list[str]:
    text = folder.definition.read_text("utf-8")
    folder.definition.write_text(text + LICENSED.format(matrix=matrix), "utf-8")
    return copy_study(folder, folder.study(), StudyFolder(to), videos=videos)


def names(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def test_what_metrics_are_measured_from_is_copied_and_nothing_else(
    folder: StudyFolder, tmp_path: Path
) -> None:
    remarks = copied(folder, tmp_path / "copy", "matrix.npy")

    speech = {"speech/segments.csv", "speech/take.wav"}
    assert names(tmp_path / "copy") == {"study.toml", "stimuli.json", *speech, *MATERIAL}
    for name in names(tmp_path / "copy"):
        assert (tmp_path / "copy" / name).read_bytes() == (folder.root / name).read_bytes()
    assert [re.findall("smplx.npz is licensed", remark) for remark in remarks] == [
        ["smplx.npz is licensed"]
    ]


def test_what_lies_outside_the_study_is_named_and_not_copied(
    folder: StudyFolder, tmp_path: Path
) -> None:
    (folder.root.parent / "outside.npy").write_bytes(b"x")

    remarks = copied(folder, tmp_path / "copy", "../outside.npy", videos=True)

    assert any("outside.npy lies outside the study" in remark for remark in remarks)
    assert "videos/pairs/000.mp4" in names(tmp_path / "copy")


def test_the_environment_names_every_package_that_is_needed() -> None:
    found = environment()

    for name in ("numpy", "pandas", "sqlalchemy", "mako", "python-dateutil", "torch", "pyrender"):
        assert found["packages"][name] == metadata.version(name)
    assert "ruff" not in found["packages"]
