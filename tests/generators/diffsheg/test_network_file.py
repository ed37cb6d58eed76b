"""A network and its normalisation in one file, and the authors' in theirs."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from generators.diffsheg.network_file import load_network, write_network
from motion.errors import InputError
from tests.generators.diffsheg.small_network import small, small_network, written_network
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


def test_equal_networks_make_equal_bytes(tmp_path: Path) -> None:
    files = [written_network(tmp_path / f"{number}.safetensors") for number in range(2)]
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_released_checkpoint_without_its_means_is_refused(tmp_path: Path) -> None:
    torch.save({"encoder": {"time_embed.0.weight": torch.zeros(1)}}, tmp_path / "released.pt")
    with pytest.raises(InputError, match="means and standard deviations") as refusal:
        load_network(tmp_path / "released.pt", "beat", None)
    assert "axis_angle_mean.npy" in str(refusal.value.remedy)


def test_another_programs_safetensors_count_as_a_released_checkpoint(tmp_path: Path) -> None:
    path = tmp_path / "other.safetensors"
    save_file({"weight": torch.zeros(1)}, path, metadata={"format": "pt"})
    with pytest.raises(InputError, match="not DiffSHEG's network for beat"):
        load_network(path, "beat", tmp_path)


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
