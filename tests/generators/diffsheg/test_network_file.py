"""A network and its normalisation in one file, and the authors' in theirs."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import torch

from generators.diffsheg.config import BEAT
from generators.diffsheg.network_file import load_network, read_normalisation, write_network
from motion.errors import InputError
from tests.generators.diffsheg.small_network import small, small_network
from training.weights_file import write_weights


@pytest.mark.parametrize("dataset", ["beat", "show"])
def test_what_is_written_comes_back(tmp_path: Path, dataset: str) -> None:
    known = small_network(dataset)
    write_network(tmp_path / "network.safetensors", known)
    found = load_network(tmp_path / "network.safetensors", "beat", None)
    assert found.dataset == dataset
    assert found.denoiser.config == known.denoiser.config
    assert not found.denoiser.training
    np.testing.assert_array_equal(found.normalisation.mean, known.normalisation.mean)
    np.testing.assert_array_equal(found.normalisation.std, known.normalisation.std)
    weights = known.denoiser.state_dict()
    assert all(torch.equal(one, weights[n]) for n, one in found.denoiser.state_dict().items())


def test_a_released_checkpoint_without_its_means_is_refused(tmp_path: Path) -> None:
    torch.save({"encoder": {"time_embed.0.weight": torch.zeros(1)}}, tmp_path / "released.pt")
    with pytest.raises(InputError, match="means and standard deviations") as refusal:
        load_network(tmp_path / "released.pt", "beat", None)
    assert "axis_angle_mean.npy" in str(refusal.value.remedy)


@pytest.mark.parametrize(
    "facts",
    [
        {"network": "evaluator"},
        {"network": "diffsheg", "dataset": "ted", "config": asdict(small("beat"))},
        {"network": "diffsheg", "dataset": "beat", "config": {"width": 3}},
        {"network": "diffsheg", "dataset": "beat", "config": asdict(small("beat"))},
    ],
    ids=["another network", "another data set", "no config", "no weights"],
)
def test_a_file_of_something_else_is_refused(tmp_path: Path, facts: dict[str, object]) -> None:
    write_weights(tmp_path / "other.safetensors", {"a": torch.zeros(1)}, facts)
    with pytest.raises(InputError, match="not of a DiffSHEG network"):
        load_network(tmp_path / "other.safetensors", "beat", None)


SMALL = replace(BEAT, gesture_width=3, expression_width=2)
FILES = {
    "axis_angle_mean": [0.0, 1.0, 2.0],
    "axis_angle_std": [1.0, 0.0, 2.3e-8],
    "json_mean": [0.1, 0.2],
    "json_std": [0.5, 0.25],
}


@pytest.fixture
def stats(tmp_path: Path) -> Path:
    for name, values in FILES.items():
        np.save(tmp_path / f"{name}.npy", np.array(values))
    return tmp_path


def test_the_bodys_values_come_first_and_then_the_faces(stats: Path) -> None:
    found = read_normalisation(stats, SMALL)
    assert found.mean.tolist() == [0.0, 1.0, 2.0, 0.1, 0.2]
    assert found.std.tolist() == [1.0, 0.0, 2.3e-8, 0.5, 0.25]


def test_the_faces_files_may_lie_in_a_folder_of_their_own(stats: Path) -> None:
    expected = read_normalisation(stats, SMALL)
    (stats / "facial52").mkdir()
    for name in ("json_mean.npy", "json_std.npy"):
        (stats / name).rename(stats / "facial52" / name)
    assert read_normalisation(stats, SMALL).mean.tolist() == expected.mean.tolist()


def test_a_missing_file_is_named(stats: Path) -> None:
    (stats / "json_std.npy").unlink()
    with pytest.raises(InputError, match=r"json_std\.npy: .*no such file"):
        read_normalisation(stats, SMALL)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.zeros(4), "shape"),
        (np.array([0.0, np.nan, 0.0]), "finite"),
        (np.array([None] * 3, dtype=object), "plain array"),
        (np.array([-1.0, 0.0, 0.0]), "negative"),
    ],
    ids=["another size", "not a number", "pickled", "negative"],
)
def test_unusable_content_is_refused(stats: Path, values: np.ndarray, said: str) -> None:
    np.save(stats / "axis_angle_std.npy", values, allow_pickle=True)
    with pytest.raises(InputError, match=said):
        read_normalisation(stats, SMALL)
