import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats import read_clip
from motion.placement import place
from studyapp.stimuli.generation import generate
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from tests.generators.diffsheg.small_network import written_network
from tests.support.studies.redefining import set_keys
from training.speech_features.hubert import stand_in

MakeTake = Callable[..., Take]


@pytest.fixture
def study(folder: StudyFolder, take: MakeTake) -> StudyFolder:
    import_take(folder, take())
    return folder


def generated_files(folder: StudyFolder) -> dict[Path, bytes]:
    made = ("rule_based", "mismatched", "broken")
    return {
        path: path.read_bytes()
        for condition in made
        for path in sorted((folder.root / "motion" / condition).glob("*.npz"))
    }


def test_every_generated_condition_gets_a_placed_clip_once(study: StudyFolder) -> None:
    reported: list[tuple[int, int]] = []
    count = generate(study, on_clip=lambda done, total, _detail="": reported.append((done, total)))
    assert (count.made, count.kept) == (9, 0)
    assert reported == [(n, 9) for n in range(1, 10)]
    for path in generated_files(study):
        clip = read_clip(path)
        assert clip.duration == pytest.approx(2.0)
        assert clip.provenance["generator"] == path.parent.name
        placed, _ = place(clip)
        np.testing.assert_allclose(clip.poses, placed.poses, atol=1e-5)
        np.testing.assert_allclose(clip.trans, placed.trans, atol=1e-5)
    for segment in study.segments():
        own = read_clip(study.clip("rule_based", segment.name))
        other = read_clip(study.clip("mismatched", segment.name))
        assert (own.poses != other.poses).any()
    assert study.study().generated()["broken"].source == "ground_truth"
    before = generated_files(study)
    assert generate(study).made == 0
    assert generated_files(study) == before


def test_an_interrupted_run_resumes(study: StudyFolder) -> None:
    def interrupt(done: int, total: int, detail: str = "") -> None:
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        generate(study, on_clip=interrupt)
    count = generate(study)
    assert (count.made, count.kept) == (5, 4)


def test_a_new_seed_or_source_motion_regenerates_clips(study: StudyFolder) -> None:
    generate(study)
    before = generated_files(study)
    set_keys(study.definition, {"seed": 2})
    assert generate(study).made == 9
    moved = study.clip("rule_based", "take_01")
    assert moved.read_bytes() != before[moved]
    set_keys(study.definition, {"seed": 1})
    generate(study)
    assert generated_files(study) == before
    ground_truth = study.clip("ground_truth", "take_01")
    ground_truth.write_bytes(study.clip("ground_truth", "take_02").read_bytes())
    count = generate(study)
    assert (count.made, count.kept) == (3, 6)


def import_another(study: StudyFolder) -> None:
    imported = study.clip("rule_based", "take_01")
    imported.parent.mkdir(parents=True)
    imported.write_bytes(study.clip("ground_truth", "take_01").read_bytes())


def lose_a_source(study: StudyFolder) -> None:
    study.clip("ground_truth", "take_02").unlink()


def reach_past_the_recording(study: StudyFolder) -> None:
    table = study.speech / "segments.csv"
    text = table.read_text().replace("take_03,take.wav,4.0,6.0", "late,take.wav,4.0,60.0")
    table.write_text(text)


@pytest.mark.parametrize(
    ("spoil", "error"),
    [
        (import_another, "this motion was not generated.*remove the generator"),
        (lose_a_source, r"take_02.*motionjury import"),
        (
            reach_past_the_recording,
            r"take\.wav, segment late: there is no excerpt from 4 s to 60 s",
        ),
    ],
)
def test_a_failed_generation_reports_its_cause_and_overwrites_nothing(
    study: StudyFolder, spoil: Callable[[StudyFolder], None], error: str
) -> None:
    spoil(study)
    before = generated_files(study)
    with pytest.raises(InputError, match=error):
        generate(study)
    assert before.items() <= generated_files(study).items()


@pytest.fixture
def networked(folder: StudyFolder, take: Callable[..., Take]) -> StudyFolder:
    """One segment; a network moves one condition and nothing else is generated."""
    import_take(folder, take(speech=2.0, motion=2.0))
    (folder.root / "models").mkdir()
    written_network(folder.root / "models" / "small.safetensors")
    learned = {"generator": "diffsheg", "checkpoint": "models/small.safetensors"}
    conditions = {"ground_truth": {}, "learned": learned}
    keys = {"reference": "ground_truth", "conditions": conditions, "catch.trials": 0}
    set_keys(folder.definition, keys)
    return folder


def test_a_network_reports_progress_and_stand_ins_and_survives_moving_the_study(
    networked: StudyFolder, tmp_path: Path
) -> None:
    shown: list[tuple[int, int, str]] = []

    def show(done: int, total: int, detail: str = "") -> None:
        shown.append((done, total, detail))

    remarks = generate(networked, on_clip=show).remarks

    names = [segment.name for segment in networked.segments()]
    assert (0, 1, f"learned/{names[0]}: 100%") in shown
    assert shown[-1] == (1, 1, "")
    assert remarks == (f"Uses stand-ins: learned: {stand_in().description}",)
    shutil.copytree(networked.root, tmp_path / "elsewhere")
    assert generate(StudyFolder(tmp_path / "elsewhere")).made == 0


def test_a_missing_checkpoint_is_named_with_its_condition(networked: StudyFolder) -> None:
    set_keys(networked.definition, {"conditions.learned.checkpoint": "models/absent.pt"})
    with pytest.raises(InputError, match=r"conditions\.learned: .*no such checkpoint") as refusal:
        generate(networked)
    assert str(networked.root / "models" / "absent.pt") in str(refusal.value)
