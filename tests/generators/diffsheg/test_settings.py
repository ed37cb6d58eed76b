"""DiffSHEG's settings."""

from __future__ import annotations

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


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        *((key, "absent", "absent: there is no such") for key in ("checkpoint", "stats", "hubert")),
        ("checkpoint", "stats", "no such checkpoint"),
        ("stats", "weights.pt", "no such folder of stats"),
    ],
)
def test_missing_files_are_named_and_not_confused_with_folders(
    model: DiffShegSettings, tmp_path: Path, key: str, value: str, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        changed(model, **{key: Path(value)}).resolved_in(tmp_path)


def test_the_fingerprint_changes_with_values_and_contents_and_not_with_where_files_lie(
    model: DiffShegSettings, tmp_path: Path
) -> None:
    fingerprints = [model.fingerprint(), changed(model, speaker=2).fingerprint()]
    elsewhere = model.checkpoint.rename(tmp_path / "other.pt")
    moved = changed(model, checkpoint=elsewhere)
    assert moved.fingerprint() == fingerprints[0]
    for file in ("other.pt", "stats/file.npy", "hubert/file.npy"):
        (tmp_path / file).write_bytes(b"other")
        fingerprints.append(changed(moved).fingerprint())
    assert len(set(fingerprints)) == 5


def test_steps_that_do_not_divide_those_of_training_and_unknown_devices_are_refused(
    model: DiffShegSettings,
) -> None:
    with pytest.raises(ValidationError, match="30 steps do not divide"):
        changed(model, steps=30)
    with pytest.raises(ValidationError, match="speaker's number, from 1"):
        changed(model, speaker=0)
    with pytest.raises(InputError, match="unknown device 'tpu'"):
        DiffSheg(changed(model, hubert=None), "tpu")
