"""Conditions that a learned generator moves."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import tomlkit

from generators.registry import load_generator
from motion.errors import InputError
from motion.formats import read_clip
from studyapp.definition.creation import new_study
from studyapp.definition.folder import StudyFolder
from studyapp.stages.generation import generate, model_of
from studyapp.stages.recordings import Take, import_take
from tests.generators.diffsheg.small_network import written_network


@pytest.fixture
def study(folder: StudyFolder, take: Callable[..., Take]) -> StudyFolder:
    """Two segments; a network moves one condition and nothing else is generated."""
    import_take(folder, take(speech=4.0, motion=4.0))
    (folder.root / "models").mkdir()
    written_network(folder.root / "models" / "small.safetensors")
    document = tomlkit.parse(folder.definition.read_text())
    document["reference"] = "ground_truth"
    document["conditions"] = {
        "ground_truth": {},
        "learned": {"generator": "diffsheg", "checkpoint": "models/small.safetensors"},
    }
    document["catch"]["trials"] = 0
    folder.definition.write_text(tomlkit.dumps(document))
    return folder


def set_key(folder: StudyFolder, key: str, value: object) -> None:
    document = tomlkit.parse(folder.definition.read_text())
    document["conditions"]["learned"][key] = value
    folder.definition.write_text(tomlkit.dumps(document))


def test_a_network_moves_every_segment_and_is_kept_while_nothing_changes(
    study: StudyFolder,
) -> None:
    assert generate(study).made == 2
    for segment in study.segments():
        facts = read_clip(study.clip("learned", segment.name)).provenance
        assert facts["generator"] == "diffsheg"
        assert "stand-in for HuBERT" in facts["stand_ins"]
    assert generate(study).made == 0


def test_another_speaker_or_another_checkpoint_makes_all_clips_anew(study: StudyFolder) -> None:
    generate(study)
    set_key(study, "speaker", 2)
    assert generate(study).made == 2
    path = study.root / "models" / "small.safetensors"
    path.write_bytes(path.read_bytes())
    assert generate(study).made == 0
    written_network(path, "show")
    assert generate(study).made == 2


def test_a_study_that_was_moved_keeps_its_clips(study: StudyFolder, tmp_path: Path) -> None:
    generate(study)
    shutil.copytree(study.root, tmp_path / "elsewhere")
    assert generate(StudyFolder(tmp_path / "elsewhere")).made == 0


def test_a_missing_checkpoint_is_named_with_its_condition(study: StudyFolder) -> None:
    set_key(study, "checkpoint", "models/absent.pt")
    with pytest.raises(InputError, match=r"conditions\.learned: .*no such checkpoint") as refusal:
        generate(study)
    assert str(study.root / "models" / "absent.pt") in str(refusal.value)


def test_all_keys_of_a_condition_reach_the_generator(study: StudyFolder) -> None:
    for name in ("stats", "hubert"):
        (study.root / name).mkdir()
        set_key(study, name, name)
    set_key(study, "dataset", "show")
    set_key(study, "speaker", 3)
    condition = study.study().conditions["learned"]
    model = model_of(study, "learned", condition)
    assert model is not None
    assert (model.dataset, model.speaker) == ("show", 3)
    assert (model.stats, model.hubert) == (study.root / "stats", study.root / "hubert")
    with pytest.raises(InputError, match="no config"):
        load_generator("diffsheg", model)


def test_a_study_whose_reference_is_called_as_a_network_expects_files(tmp_path: Path) -> None:
    made = new_study(tmp_path / "study.toml", name="study", reference="diffsheg")
    assert made.conditions["diffsheg"].generator is None
