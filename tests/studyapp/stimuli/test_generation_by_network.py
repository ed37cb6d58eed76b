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


def test_a_network_shows_its_progress_remarks_what_it_lacks_and_moves_with_the_study(
    study: StudyFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("training.speech_features.speech_frames.LONGEST_AT_ONCE", 1.0)
    shown: list[tuple[int, int, str]] = []

    def show(done: int, total: int, detail: str = "") -> None:
        shown.append((done, total, detail))

    remarks = generate(study, on_clip=show).remarks

    names = [segment.name for segment in study.segments()]
    assert (0, 1, f"learned/{names[0]}: 100%") in shown
    assert shown[-1] == (1, 1, "")
    assert remarks == (
        f"Uses stand-ins: learned: {stand_in().description}",
        "Long speech was processed 60 s at once with 4 s before and 4 s ahead: learned: "
        + ", ".join(names),
    )
    shutil.copytree(study.root, tmp_path / "elsewhere")
    assert generate(StudyFolder(tmp_path / "elsewhere")).made == 0


def test_a_missing_checkpoint_is_named_with_its_condition(study: StudyFolder) -> None:
    with edited(study.definition) as document:
        document["conditions"]["learned"]["checkpoint"] = "models/absent.pt"
    with pytest.raises(InputError, match=r"conditions\.learned: .*no such checkpoint") as refusal:
        generate(study)
    assert str(study.root / "models" / "absent.pt") in str(refusal.value)
