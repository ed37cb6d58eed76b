"""DiffSHEG learns, reports its data, and resumes where it was stopped."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from benchmarks.learned_motion.networks import write_untrained
from generators.diffsheg.config import BEAT, PRESETS
from generators.diffsheg.losses import LOSSES, LossWeights
from generators.diffsheg.network_file import load_network
from generators.diffsheg.train import METRIC, DiffShegTask, normalisation_of, train_diffsheg
from generators.registry import TrainingRequest
from motion.errors import InputError
from tests.generators.diffsheg.small_network import smaller
from tests.generators.small_training import Learn, test_training_stays_on_its_device, training_on
from tests.training.takes import takes_of_curves
from training.data.feature_cache import PreparedTakes
from training.data.take import Kind, TakeFolder
from training.data.windows import Windows
from training.speakers import Speakers

__all__ = ["test_training_stays_on_its_device"]

SMALL = replace(smaller(PRESETS["tiny"]["beat"].network), dropout=0.0)


@pytest.fixture(scope="module")
def takes() -> PreparedTakes:
    """Two curves decide all motion: the loudness of speech, and one that nothing predicts."""
    chance = np.random.default_rng(3)
    mixing = chance.standard_normal((2, BEAT.motion_width))

    def features_of(curves: np.ndarray) -> dict[str, np.ndarray]:
        gesture, expression = np.split(curves @ mixing, [BEAT.gesture_width], axis=1)
        return {
            "gesture": gesture,
            "expression": expression,
            "mel": np.repeat(10 ** curves[:, :1], BEAT.audio_width, axis=1),
            "hubert": chance.standard_normal((len(curves), BEAT.speech_features)),
            "semantic": np.zeros((len(curves), 1)),
        }

    # The third speaker is held out.
    speakers = ["3" if number == 4 else "12"[number % 2] for number in range(12)]
    return takes_of_curves(
        features_of,
        speakers=speakers,
        frame_rate=BEAT.frame_rate,
        curves=2,
        skipped=(InputError("the sound is shorter than the motion", where="7.wav"),),
    )


@pytest.fixture(autouse=True)
def _few_are_held_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("generators.diffsheg.train.VALIDATION_WINDOWS", 128)


@pytest.fixture
def learn(takes: PreparedTakes, monkeypatch: pytest.MonkeyPatch) -> Learn:
    tiny = PRESETS["tiny"]["beat"]
    small = replace(tiny, network=SMALL)
    monkeypatch.setattr("generators.diffsheg.train.PRESETS", {**PRESETS, "tiny": {"beat": small}})
    return training_on(takes, train_diffsheg, monkeypatch, batch_size=16, learning_rate=1e-2)


def task_of(takes: PreparedTakes, **changes: Any) -> DiffShegTask:
    task = DiffShegTask(
        config=SMALL,
        weights=LOSSES["paper"],
        training=Windows(takes, split="train", frames=34, stride=10),
        held_out=Windows(takes, split="validation", frames=34, stride=34),
        normalisation=normalisation_of(takes),
        speakers=Speakers(("1", "2"), SMALL.speakers),
    )
    return replace(task, **changes)


def test_a_short_training_betters_the_network_that_it_began_with(
    learn: Learn, takes: PreparedTakes, tmp_path: Path
) -> None:
    out = tmp_path / "small.safetensors"
    outcome = learn(24, out)
    facts = load_network(out, "beat", None).training
    task = task_of(takes, weights=LOSSES["steps"])
    with torch.no_grad():
        untrained = task.validation(task.network().eval())
    for measure in (METRIC, "loss"):
        assert facts["held_out"][measure] < 0.85 * untrained[measure]
    before = tmp_path / "untrained.safetensors"
    write_untrained(out, before)
    written = load_network(before, "beat", None).model.state_dict()
    torch.manual_seed(facts["config"]["seed"])
    torch.testing.assert_close(written, task.network().state_dict(), rtol=0, atol=0)
    assert outcome.skipped == takes.skipped != ()
    assert f"noise and reconstruction {facts['held_out'][METRIC]:.4g}" in outcome.sentences[1]
    assert "9 takes by 2 speakers (1, 2)" in outcome.sentences[0]
    assert "but not its words" in " ".join(outcome.warnings)


def test_the_file_records_its_training_and_another_ablation_cannot_resume_it(
    learn: Learn, tmp_path: Path
) -> None:
    out = tmp_path / "small.safetensors"
    learn(2, out, ablation="without_x0", preset="release")
    network = load_network(out, "beat", None)
    assert network.dataset == "beat"
    assert network.speakers == Speakers(("1", "2"), SMALL.speakers)
    assert str(network.hubert).startswith("stand-in for HuBERT")
    assert network.model.config.flow == "none"
    assert network.training["losses"] == "release"
    assert network.training["data"]["sha256"] == "c" * 64
    assert network.training["config"]["steps"] == 2
    assert network.training["versions"]["torch"] == torch.__version__
    with pytest.raises(InputError, match=r"loss noise was 1000.*network flow was 'none' and is"):
        learn(3, out, ablation="naive_concat", preset="paper")


def test_motion_is_normalised_by_the_training_split_only(takes: PreparedTakes) -> None:
    chosen = [number for number, take in enumerate(takes.takes) if take.split == "train"]
    gestures = np.concatenate([takes.arrays["gesture"][number] for number in chosen])
    result = normalisation_of(takes)
    np.testing.assert_allclose(result.mean[:141], gestures.mean(axis=0, dtype=float), atol=1e-6)
    np.testing.assert_allclose(result.std[:141], gestures.std(axis=0, dtype=float), rtol=1e-6)


def test_validation_is_deterministic_and_selects_weights_without_velocity(
    takes: PreparedTakes,
) -> None:
    task = task_of(takes, weights=LossWeights(noise=2, velocity=10, reconstruction=3))
    network = task.network().eval()
    measured = []
    for seed in (1, 2):
        torch.manual_seed(seed)
        with torch.no_grad():
            measured.append(task.validation(network))
    result = measured[0]
    assert result == measured[1]
    assert list(result) == [METRIC, "loss", "noise", "velocity", "reconstruction"]
    assert result[METRIC] == pytest.approx(2 * result["noise"] + 3 * result["reconstruction"])


@pytest.mark.parametrize(
    ("kind", "config", "message"),
    [
        ("beat", "show", "config show does not fit recordings of the layout 'beat'.*--config"),
        ("ted", "tiny", "config tiny does not fit .*'ted'.*with faces"),
        ("beat", "tiny", "none of the 0 takes can be used"),
    ],
)
def test_unsuitable_recordings_are_refused(
    kind: Kind, config: str, message: str, tmp_path: Path
) -> None:
    takes = TakeFolder(kind=kind, takes=(), speakers=())
    request = TrainingRequest(takes=takes, out=tmp_path / "n", cache=tmp_path, config=config)
    with pytest.raises(InputError, match=message):
        train_diffsheg(request)
