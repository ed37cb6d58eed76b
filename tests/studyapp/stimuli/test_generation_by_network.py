"""Conditions that a learned generator moves."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.stimuli.generation import generate
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from tests.generators.diffsheg.small_network import written_network
from tests.support.studies.edited_study import edited
from training.speech_features.hubert import stand_in


@pytest.fixture
def study(folder: StudyFolder, take: Callable[..., Take]) -> StudyFolder:
    """One segment; a network moves one condition and nothing else is generated."""
    import_take(folder, take(speech=2.0, motion=2.0))
    (folder.root / "models").mkdir()
    written_network(folder.root / "models" / "small.safetensors")
    with edited(folder.definition) as document:
        document["reference"] = "ground_truth"
        document["conditions"] = {
            "ground_truth": {},
            "learned": {"generator": "diffsheg", "checkpoint": "models/small.safetensors"},
        }
        document["catch"]["trials"] = 0
    return folder


def set_key(folder: StudyFolder, key: str, value: object) -> None:
    with edited(folder.definition) as document:
        document["conditions"]["learned"][key] = value


def test_a_moved_study_keeps_its_clips(study: StudyFolder, tmp_path: Path) -> None:
    generate(study)
    shutil.copytree(study.root, tmp_path / "elsewhere")
    assert generate(StudyFolder(tmp_path / "elsewhere")).made == 0


def test_a_missing_checkpoint_is_named_with_its_condition(study: StudyFolder) -> None:
    set_key(study, "checkpoint", "models/absent.pt")
    with pytest.raises(InputError, match=r"conditions\.learned: .*no such checkpoint") as refusal:
        generate(study)
    assert str(study.root / "models" / "absent.pt") in str(refusal.value)


def test_progress_within_a_clip_is_shown(study: StudyFolder) -> None:
    shown: list[tuple[int, int, str]] = []

    def show(done: int, total: int, detail: str = "") -> None:
        shown.append((done, total, detail))

    generate(study, on_clip=show)
    first = study.segments()[0].name
    assert (0, 1, f"learned/{first}: 100%") in shown
    assert shown[-1] == (1, 1, "")


def test_stand_ins_and_speech_processed_in_parts_are_remarked(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("training.speech_features.speech_frames.LONGEST_AT_ONCE", 1.0)
    remarks = generate(study).remarks
    names = ", ".join(segment.name for segment in study.segments())
    assert remarks[0] == (f"Uses stand-ins: learned: {stand_in().description}")
    assert remarks[1] == (
        f"Long speech was processed 60 s at once with 4 s before and 4 s ahead: learned: {names}"
    )
