"""What DiffSHEG is told."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from generators.diffsheg.generate import DiffSheg
from generators.diffsheg.settings import DiffShegSettings, SamplingSettings
from motion.errors import InputError
from motion.files import digest


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
def test_what_is_not_there_is_named(model: DiffShegSettings, tmp_path: Path, what: str) -> None:
    absent = tmp_path / "absent"
    with pytest.raises(InputError, match=re.escape(str(absent))):
        changed(model, **{what: Path("absent")}).within(tmp_path)


def test_a_file_is_no_folder_and_a_folder_no_file(model: DiffShegSettings, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such checkpoint"):
        changed(model, checkpoint=tmp_path / "stats").within(tmp_path)
    with pytest.raises(InputError, match="no such folder of stats"):
        changed(model, stats=tmp_path / "weights.pt").within(tmp_path)


def test_values_out_of_range_are_refused(model: DiffShegSettings) -> None:
    with pytest.raises(ValidationError, match="'beat' or 'show'"):
        changed(model, dataset="ted")
    with pytest.raises(ValidationError, match="speaker's number, from 1"):
        changed(model, speaker=0)


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
    elsewhere = model.checkpoint.rename(tmp_path / "other.pt")
    assert changed(model, checkpoint=elsewhere).fingerprint() == model.fingerprint()


def test_the_fingerprint_changes_with_how_windows_are_sampled_and_not_with_its_name(
    model: DiffShegSettings,
) -> None:
    careful = changed(model, sampling=SamplingSettings(preset="careful"))
    assert careful.fingerprint() != model.fingerprint()
    same = changed(model, sampling=SamplingSettings(preset="fast", jump_count=5))
    assert same.fingerprint() == careful.fingerprint()
    wider = changed(model, sampling=SamplingSettings(overlap=4))
    assert wider.fingerprint() != model.fingerprint()


@pytest.mark.parametrize(
    ("values", "known"),
    [
        ({}, "c169d16ee6ba1a22e5cfe0219b75cf8a"),
        ({"dataset": "show", "speaker": 2, "stats": True}, "984bdc6665debfda4bbaea071c120b4a"),
        (
            {"speaker": "ada", "sampling": {"preset": "careful", "overlap": 6, "blend_below": 0.1}},
            "bdfa61eba422634a8b115de8ba84df2e",
        ),
    ],
)
def test_clips_that_were_made_before_still_fit(
    model: DiffShegSettings, tmp_path: Path, values: dict[str, Any], known: str
) -> None:
    for folder in ("stats", "hubert"):
        (tmp_path / folder / "facial52").mkdir()
        (tmp_path / folder / "facial52" / "a.npy").write_bytes(b"a")
    values = values | {
        "stats": model.stats if "stats" in values else None,
        "hubert": model.hubert if values else None,
    }
    assert digest(*changed(model, **values).fingerprint()) == known


def test_another_device_makes_no_clip_anew_and_an_unknown_one_is_refused(
    model: DiffShegSettings,
) -> None:
    assert "device" not in DiffShegSettings.model_fields
    with pytest.raises(InputError, match="unknown device 'tpu'"):
        DiffSheg(changed(model, hubert=None), "tpu")
