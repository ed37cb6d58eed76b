"""DiffSHEG's settings."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from generators.diffsheg.generate import DiffSheg
from generators.learned_settings import DiffShegSettings
from motion.errors import InputError


@pytest.fixture
def model(tmp_path: Path) -> DiffShegSettings:
    (tmp_path / "weights.pt").write_bytes(b"weights")
    for folder in ("stats", "hubert"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "file.npy").write_bytes(folder.encode())
    return DiffShegSettings(
        checkpoint=tmp_path / "weights.pt", stats=tmp_path / "stats", hubert=tmp_path / "hubert"
    )


def changed(model: DiffShegSettings, **values: Any) -> DiffShegSettings:
    kept = {name: getattr(model, name) for name in DiffShegSettings.model_fields}
    return DiffShegSettings(**(kept | values))


@pytest.mark.parametrize("what", ["checkpoint", "stats", "hubert"])
def test_missing_files_are_named(model: DiffShegSettings, tmp_path: Path, what: str) -> None:
    absent = tmp_path / "absent"
    with pytest.raises(InputError, match=re.escape(str(absent))):
        changed(model, **{what: Path("absent")}).resolved_in(tmp_path)


def test_files_and_folders_are_not_confused(model: DiffShegSettings, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such checkpoint"):
        changed(model, checkpoint=tmp_path / "stats").resolved_in(tmp_path)
    with pytest.raises(InputError, match="no such folder of stats"):
        changed(model, stats=tmp_path / "weights.pt").resolved_in(tmp_path)


def test_values_out_of_range_are_refused(model: DiffShegSettings) -> None:
    with pytest.raises(ValidationError, match="'beat' or 'show'"):
        changed(model, dataset="ted")
    with pytest.raises(ValidationError, match="speaker's number, from 1"):
        changed(model, speaker=0)
    with pytest.raises(ValidationError, match="'smooth', 'fast', 'careful' or 'plain'"):
        changed(model, sampling="hasty")
    with pytest.raises(ValidationError, match="30 steps do not divide"):
        changed(model, steps=30)
    with pytest.raises(ValidationError, match="greater than or equal to 0"):
        changed(model, overlap=-1)


@pytest.mark.parametrize("file", ["weights.pt", "stats/file.npy", "hubert/file.npy"])
def test_the_fingerprint_changes_with_the_content_of_every_file(
    model: DiffShegSettings, tmp_path: Path, file: str
) -> None:
    before = model.fingerprint()
    assert changed(model).fingerprint() == before
    (tmp_path / file).write_bytes(b"other")
    assert changed(model).fingerprint() != before


def test_the_fingerprint_changes_with_values_and_not_with_where_files_lie(
    model: DiffShegSettings, tmp_path: Path
) -> None:
    assert changed(model, speaker=2).fingerprint() != model.fingerprint()
    assert changed(model, dataset="show").fingerprint() != model.fingerprint()
    assert changed(model, sampling="careful").fingerprint() != model.fingerprint()
    assert changed(model, overlap=4).fingerprint() != model.fingerprint()
    before = model.fingerprint()
    elsewhere = model.checkpoint.rename(tmp_path / "other.pt")
    assert changed(model, checkpoint=elsewhere).fingerprint() == before


def test_the_device_is_not_a_setting_and_an_unknown_one_is_refused(
    model: DiffShegSettings,
) -> None:
    assert "device" not in DiffShegSettings.model_fields
    with pytest.raises(InputError, match="unknown device 'tpu'"):
        DiffSheg(changed(model, hubert=None), "tpu")
