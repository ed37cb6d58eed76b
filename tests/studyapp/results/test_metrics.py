import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from motion.errors import InputError
from studyapp.results.metrics import measure_folders, measure_study
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from tests.analysis.evaluators.published_weights import write_checkpoint

QUICK: Mapping[str, Any] = {"presets": ("genea", "s2ue"), "processes": 1}


@pytest.fixture
def folders(motion_file: Callable[..., Path], tmp_path: Path) -> Callable[..., Path]:
    """Return a maker of folders of motion files; a name with a slash makes a folder in it."""

    def make(folder: str, *names: str) -> Path:
        for number, name in enumerate(names):
            target = tmp_path / folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(motion_file(1.0 + number / 30, name="made"), target)
        return tmp_path / folder

    return make


def test_a_study_is_compared_with_its_ground_truth_also_by_the_evaluator_that_it_names(
    folder: StudyFolder, take: Callable[..., Take]
) -> None:
    long = take(speech=9.0, motion=9.0, segment=3.0)
    import_take(folder, long)
    other = next(name for name in folder.study().conditions if name != "ground_truth")
    shutil.rmtree(folder.root / "motion")
    with pytest.raises(InputError, match=r"no motion file.*motionjury generate"):
        measure_study(folder, **QUICK)
    import_take(folder, long)
    shutil.copytree(folder.root / "motion" / "ground_truth", folder.root / "motion" / other)
    metrics = measure_study(folder, **QUICK)
    found = {(s.condition, s.name): s for s in metrics.conditions}
    assert found[other, "mean absolute error (MAJE, s2ue)"].value == 0
    assert ("ground_truth", "mean absolute error (MAJE, s2ue)") not in found
    assert found["ground_truth", "jerk (genea)"].clips == 3
    assert list(folder.joint_positions.iterdir())

    # The study names a published evaluator.
    text = folder.definition.read_text("utf-8")
    named = 'evaluator = { preset = "ted", file = "ted.bin" }\n'
    folder.definition.write_text(named + text, "utf-8")
    with pytest.raises(InputError, match="no such file"):
        measure_study(folder, **QUICK)
    write_checkpoint(folder.root, "ted")
    measured = measure_study(folder, **QUICK).conditions
    names = {score.name for score in measured if score.condition == other}
    published = "FGD (TED's evaluator)", "FGD by the published rule (TED's evaluator)"
    assert {*published} <= names


def test_a_folder_is_one_condition_and_its_subfolders_are_several(
    folders: Callable[..., Path],
) -> None:
    flat = folders("flat", "a.npz", "b.npz")
    deep = folders("deep", "ours/a.npz", "theirs/a.npz")
    (deep / ".hidden").mkdir()
    for folder, named in ((flat, ["flat"]), (deep, ["ours", "theirs"])):
        metrics = measure_folders(folder, None, None, **QUICK)
        assert list(dict.fromkeys(s.condition for s in metrics.conditions)) == named


def test_the_reference_is_measured_and_matched_by_file_name(
    folders: Callable[..., Path], tmp_path: Path
) -> None:
    scores = tmp_path / "semantics"
    scores.mkdir()
    (scores / "a.txt").write_text("beat\t0\t1\t1\t0.3\t", encoding="utf-8")
    metrics = measure_folders(
        folders("ours", "a.npz"),
        folders("recorded", "a.npz", "b.npz"),
        None,
        semantics=scores,
        presets=("amuse", "genea", "s2ue"),
        processes=1,
    )
    found = {(s.condition, s.name): s for s in metrics.conditions}
    assert found["ours", "mean absolute error (MAJE, s2ue)"].value == 0
    assert found["recorded", "jerk (genea)"].clips == 2
    recalled = next(s for s in metrics.clips if "recall" in s.result.name)
    assert (recalled.condition, recalled.result.value) == ("ours", 1)


@pytest.mark.slow
def test_motion_and_speech_of_any_format_are_matched_by_name(
    folders: Callable[..., Path], speech_file: Callable[..., Path], shared_data: Path
) -> None:
    folder = folders("brought", "take.npz")
    shutil.copy(shared_data / "aitviewer_sample.bvh", folder / "other.bvh")
    speech = speech_file(1.0).parent / "spoken"
    speech.mkdir()
    shutil.copy(speech_file(1.0), speech / "take.aiff")
    metrics = measure_folders(folder, None, speech, presets=("amuse",), processes=1)
    names = {(s.segment, s.result.name.split(" (")[0]) for s in metrics.clips}
    assert {("take", "jerk"), ("other", "jerk"), ("take", "beat alignment")} <= names
    assert ("other", "beat alignment") not in names


@pytest.mark.parametrize(
    ("made", "reference", "said"),
    [
        ((), None, "no such folder"),
        (("a.npz", "a.bvh"), None, "a.bvh and a.npz have the same segment"),
        (("a.npz",), ("b.npz",), "no reference has the name"),
        (("recorded/a.npz",), ("a.npz",), "name of the reference, 'recorded'"),
    ],
)
def test_mismatched_folders_are_refused(
    folders: Callable[..., Path],
    made: tuple[str, ...],
    reference: tuple[str, ...] | None,
    said: str,
) -> None:
    generated = folders("ours", *made)
    recorded = folders("recorded", *reference) if reference else None
    with pytest.raises(InputError, match=said):
        measure_folders(generated, recorded, None, **QUICK)
