"""What a learned generator is given."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from generators.diffsheg.walk import SamplingSettings
from generators.model_settings import ModelSettings
from motion.errors import InputError


@pytest.fixture
def model(tmp_path: Path) -> ModelSettings:
    (tmp_path / "weights.pt").write_bytes(b"weights")
    for folder in ("stats", "hubert"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "file.npy").write_bytes(folder.encode())
    return ModelSettings(
        checkpoint=tmp_path / "weights.pt", stats=tmp_path / "stats", hubert=tmp_path / "hubert"
    )


@pytest.mark.parametrize("what", ["checkpoint", "stats", "hubert"])
def test_what_is_not_there_is_named(model: ModelSettings, tmp_path: Path, what: str) -> None:
    absent = tmp_path / "absent"
    with pytest.raises(InputError, match=re.escape(str(absent))):
        replace(model, **{what: absent})


def test_values_out_of_range_are_refused(model: ModelSettings) -> None:
    with pytest.raises(InputError, match="no data set 'ted'"):
        replace(model, dataset="ted")
    with pytest.raises(InputError, match="no speaker 0"):
        replace(model, speaker=0)


@pytest.mark.parametrize("file", ["weights.pt", "stats/file.npy", "hubert/file.npy"])
def test_the_fingerprint_changes_with_the_content_of_every_file(
    model: ModelSettings, tmp_path: Path, file: str
) -> None:
    before = model.fingerprint()
    assert replace(model).fingerprint() == before
    (tmp_path / file).write_bytes(b"other")
    assert replace(model).fingerprint() != before


def test_the_fingerprint_changes_with_values_and_not_with_where_files_lie(
    model: ModelSettings, tmp_path: Path
) -> None:
    assert replace(model, speaker=2).fingerprint() != model.fingerprint()
    assert replace(model, dataset="show").fingerprint() != model.fingerprint()
    elsewhere = model.checkpoint.rename(tmp_path / "other.pt")
    assert replace(model, checkpoint=elsewhere).fingerprint() == model.fingerprint()


def test_the_fingerprint_changes_with_how_windows_are_sampled_and_not_with_its_name(
    model: ModelSettings,
) -> None:
    careful = replace(model, sampling=SamplingSettings(preset="careful"))
    assert careful.fingerprint() != model.fingerprint()
    same = replace(model, sampling=SamplingSettings(preset="fast", jump_count=5))
    assert same.fingerprint() == careful.fingerprint()
    wider = replace(model, sampling=SamplingSettings(overlap=4))
    assert wider.fingerprint() != model.fingerprint()


def test_another_device_makes_no_clip_anew(model: ModelSettings) -> None:
    assert replace(model, device="cuda").fingerprint() == model.fingerprint()
    with pytest.raises(InputError, match="no device 'tpu'"):
        replace(model, device="tpu")
