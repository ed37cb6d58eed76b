"""A learned generator from other code works like the built-in ones."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from pydantic import Field

from generators.interface import OnPart, SpeechSegment, StudyClips, ignore_progress
from generators.learned_settings import ModelSettings
from generators.registry import GENERATORS, Entry
from generators.settings import File
from motion.clip import MotionClip
from motion.formats import read_clip
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from studyapp.study.interview import source_descriptions
from studyapp.study.settings.reading import read_study
from tests.support.command_line import refused, run
from tests.support.studies.redefining import set_keys
from tests.support.studies.takes import write_speech


class SwaySettings(ModelSettings):
    """Settings of a swaying body."""

    emotion: str | None = Field(None, description="An emotion, or a recording of one.")
    angle: float = Field(0.1, gt=0, le=1, description="Radians to either side.")
    melody: File | None = Field(None, description="A recording to sway to.")
    pace: Literal["slow", "brisk"] = Field("slow", description="How fast.")
    turns: int = Field(1, description="Turns a second.")


class PairSettings(ModelSettings):
    """Settings with a second network."""

    ear: File


class Sway:
    """Sways about the vertical; its weights are a number in a file."""

    name = "sway"
    version = "1"
    needs_source = False

    def __init__(self, settings: SwaySettings, device: str) -> None:
        self._settings = settings
        self._device = device

    def generate(
        self,
        speech: SpeechSegment,
        *,
        seed: int,
        frame_rate: float,
        source: StudyClips | None = None,
        on_part: OnPart = ignore_progress,
    ) -> MotionClip:
        frames = speech.frame_count(frame_rate)
        poses = np.zeros((frames, 55, 3), np.float32)
        learned = float(self._settings.checkpoint.read_text())
        turns = learned * self._settings.turns * np.arange(frames) / frame_rate
        poses[:, 3, 1] = self._settings.angle * np.sin(turns)
        trans = np.zeros((frames, 3), np.float32)
        clip = MotionClip(poses=poses, trans=trans, frame_rate=frame_rate)
        told = self._settings.model_dump_json(exclude={"checkpoint"})
        return clip.with_provenance(
            generator=self.name, seed=str(seed), segment=speech.segment.name, told=told
        )


@pytest.fixture(autouse=True)
def weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    entry = Entry(home=f"{__name__}:Sway", settings=f"{__name__}:SwaySettings")
    monkeypatch.setitem(GENERATORS, "sway", entry)
    path = tmp_path / "sway.txt"
    path.write_text("6.3")
    return path


@pytest.fixture
def speech(tmp_path: Path) -> Path:
    return write_speech(tmp_path / "hello.wav", 1)


def set_condition(folder: StudyFolder, **keys: Any) -> None:
    conditions = {"ground_truth": {}, "ours": {"generator": "sway", **keys}}
    made = {"reference": "ground_truth", "conditions": conditions, "catch.trials": 0}
    set_keys(folder.definition, made)


def test_changing_any_setting_regenerates_clips(
    folder: StudyFolder, take: Callable[..., Take], weights: Path
) -> None:
    import_take(folder, take(speech=2.0, motion=2.0))
    (folder.root / "sway.txt").write_text("6.3")
    made = []
    brisk = {"angle": 0.2, "pace": "brisk"}
    for keys in ({}, {}, {"angle": 0.2}, brisk, {**brisk, "turns": 2}):
        set_condition(folder, checkpoint="sway.txt", **keys)
        made.append(run("generate", folder.root))
    (folder.root / "sway.txt").write_text("3")
    made.append(run("generate", folder.root))

    assert [("kept 1" in output, "Generated 1" in output) for output in made] == [
        (False, True), (True, False), *[(False, True)] * 4,
    ]  # fmt: skip
    told = read_clip(next((folder.root / "motion" / "ours").glob("*.npz"))).provenance["told"]
    assert '"angle":0.2' in told
    assert '"pace":"brisk","turns":2' in told


@pytest.mark.parametrize(
    ("keys", "error"),
    [
        ({}, "checkpoint: generator 'sway' needs a checkpoint"),
        ({"chekpoint": "a"}, "chekpoint: unknown key (did you mean 'checkpoint'?)"),
        (
            {"hubert": "a"},
            "hubert: unknown key (known are checkpoint, emotion, angle, melody, pace and turns)",
        ),
        ({"angle": 2}, "angle: must be less than or equal to 1"),
        ({"melody": ""}, "melody: must be a path in quotes"),
    ],
)
def test_check_names_wrong_settings_of_a_condition(
    folder: StudyFolder, keys: dict[str, Any], error: str
) -> None:
    given = {"checkpoint": "sway.txt"} if keys and "chekpoint" not in keys else {}
    set_condition(folder, **given, **keys)
    told = " ".join(refused("check", folder.root).split())
    assert f"study.toml: conditions.ours.{error} (line " in told


def test_the_generators_options_are_on_the_command_line(
    speech: Path, weights: Path, tmp_path: Path
) -> None:
    options = ("--checkpoint", weights, "--angle", 0.3, "--pace", "brisk", "--turns", 3)
    heard = ("--speech", speech, "--melody", speech, "--emotion", "laughter.wav")
    run("generate", "--generator", "sway", *heard, *options, "--out", tmp_path / "out")
    told = read_clip(tmp_path / "out" / "hello.npz").provenance["told"]
    assert '"emotion":"laughter.wav","angle":0.3' in told
    assert f'"melody":"{speech}","pace":"brisk","turns":3' in told


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (("diffsheg", "--angle", 0.1), "--angle belongs to a learned generator, not to diffsheg"),
        (("sway", "--checkpoint", "absent.txt"), "there is no such checkpoint"),
        (("sway", "--checkpoint", "{weights}", "--angle", 2), "angle: must be less than"),
        (("static", "--emotion", "laughter.wav"), "unknown emotion 'laughter.wav'"),
    ],
)
def test_the_command_line_names_options_that_do_not_fit(
    speech: Path, weights: Path, tmp_path: Path, options: tuple[object, ...], error: str
) -> None:
    given = [str(option).replace("{weights}", str(weights)) for option in options]
    said = refused("generate", "--speech", speech, "--out", tmp_path / "out", "--generator", *given)
    assert error in said


def test_a_condition_lists_all_files_of_its_network(
    tmp_path: Path, weights: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    entry = Entry(home=f"{__name__}:Sway", settings=f"{__name__}:PairSettings")
    monkeypatch.setitem(GENERATORS, "pair", entry)
    (tmp_path / "ear.txt").write_text("1")

    ours = f"ours=pair:{weights},{tmp_path / 'ear.txt'}"
    run("init", tmp_path / "a", "--condition", "real=files", "--condition", ours)
    half = refused("init", tmp_path / "b", "--condition", f"ours=pair:{weights}")

    settings = read_study(tmp_path / "a" / "study.toml").conditions["ours"].settings
    assert settings == PairSettings(checkpoint=weights, ear=tmp_path / "ear.txt")
    assert "Give pair:FILE,FILE, its checkpoint and ear" in half
    assert "pair:FILE,FILE" in source_descriptions()
