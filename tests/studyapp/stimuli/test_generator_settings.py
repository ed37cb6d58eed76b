"""Settings of learned generators, in a study and on the command line."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from generators.learned_settings import AmuseSettings
from studyapp.stimuli.generation import generate
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from studyapp.study.interview import source_descriptions
from studyapp.study.settings.reading import read_study
from tests.generators.diffsheg.small_network import written_network
from tests.support.command_line import refused, run
from tests.support.studies.redefining import set_keys
from tests.support.studies.takes import write_speech


def set_condition(folder: StudyFolder, **keys: Any) -> None:
    conditions = {"ground_truth": {}, "ours": {"generator": "diffsheg", **keys}}
    made = {"reference": "ground_truth", "conditions": conditions, "catch.trials": 0}
    set_keys(folder.definition, made)


def test_changing_any_setting_regenerates_clips(
    folder: StudyFolder, take: Callable[..., Take]
) -> None:
    import_take(folder, take(speech=2.0, motion=2.0))
    network = written_network(folder.root / "small.safetensors")
    made = []
    for keys in ({}, {}, {"speaker": 2}, {"speaker": 2, "sampling": "fast"}):
        set_condition(folder, checkpoint="small.safetensors", **keys)
        made.append(generate(folder).made)
    written_network(network, dataset="show")
    made.append(generate(folder).made)

    assert made == [1, 0, 1, 1, 1]


@pytest.mark.parametrize(
    ("keys", "error"),
    [
        ({}, "checkpoint: is missing"),
        ({"words": "a"}, "words: unknown key in line"),
        ({"steps": 0}, "steps: must be greater than or equal to 1"),
        ({"hubert": ""}, "hubert: must be a path in quotes"),
    ],
)
def test_check_names_wrong_settings_of_a_condition(
    folder: StudyFolder, keys: dict[str, Any], error: str
) -> None:
    given = {"checkpoint": "small.pt"} if keys else {}
    set_condition(folder, **given, **keys)
    told = " ".join(refused("check", folder.root).split())
    assert f"study.toml: conditions.ours.{error}" in told
    assert "line " in told


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (("static", "--speaker", 2), "speaker: unknown key"),
        (("diffsheg", "--checkpoint", "absent.pt"), "there is no such checkpoint"),
        (("diffsheg", "--checkpoint", "{network}", "--steps", 0), "steps: must be greater"),
        (("static", "--emotion", "laughter.wav"), "unknown emotion 'laughter.wav'"),
    ],
)
def test_the_command_line_names_options_that_do_not_fit(
    tmp_path: Path, options: tuple[object, ...], error: str
) -> None:
    network, speech = tmp_path / "small.pt", write_speech(tmp_path / "hello.wav", 1)
    network.touch()
    given = [str(option).replace("{network}", str(network)) for option in options]
    said = refused("generate", "--speech", speech, "--out", tmp_path / "out", "--generator", *given)
    assert error in said


def test_a_condition_lists_all_files_of_its_network(tmp_path: Path) -> None:
    motion, speech = tmp_path / "motion.pt", tmp_path / "speech.pt"
    motion.touch()
    speech.touch()

    ours = f"ours=amuse:{motion},{speech}"
    run("init", tmp_path / "a", "--condition", "real=files", "--condition", ours)
    half = refused("init", tmp_path / "b", "--condition", f"ours=amuse:{motion}")

    settings = read_study(tmp_path / "a" / "study.toml").conditions["ours"].settings
    assert settings == AmuseSettings(checkpoint=motion, speech_model=speech)
    assert "Give amuse:FILE,FILE, its checkpoint and speech_model" in half
    assert "amuse:FILE,FILE" in source_descriptions()
