"""A network and its normalisation in one file, and the authors' in theirs."""

import json
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from generators.diffsheg.config import BEAT
from generators.diffsheg.network_file import (
    load_network,
    load_released,
    read_normalisation,
    read_weights,
)
from motion.errors import InputError
from tests.generators.diffsheg.small_network import small
from tests.generators.reference_weights import REFERENCE, reference_arrays, reference_weights
from training.weights_file import write_weights


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
        {"network": "diffsheg", "dataset": "beat", "config": asdict(small("beat"))},
    ],
    ids=["another network", "another data set", "no weights"],
)
def test_a_file_of_another_kind_is_refused(tmp_path: Path, facts: dict[str, object]) -> None:
    write_weights(tmp_path / "other.safetensors", {"a": torch.zeros(1)}, facts)
    with pytest.raises(InputError, match="not of a DiffSHEG network"):
        load_network(tmp_path / "other.safetensors", "beat", None)


SMALL = replace(BEAT, gesture_width=3, expression_width=2)
FILES = {
    "axis_angle_mean": [0.0, 1.0, 2.0],
    "axis_angle_std": [1.0, 0.0, 2.3e-8],
    "facial52/json_mean": [0.1, 0.2],
    "json_std": [0.5, 0.25],
}


def test_body_statistics_precede_the_faces_which_may_be_in_another_folder(tmp_path: Path) -> None:
    (tmp_path / "facial52").mkdir()
    for name, values in FILES.items():
        np.save(tmp_path / f"{name}.npy", np.array(values))
    result = read_normalisation(tmp_path, SMALL)
    assert result.mean.tolist() == [0.0, 1.0, 2.0, 0.1, 0.2]
    assert result.std.tolist() == [1.0, 0.0, 2.3e-8, 0.5, 0.25]
    (tmp_path / "json_std.npy").unlink()
    with pytest.raises(InputError, match=r"json_std\.npy: .*not an array of 2 finite numbers"):
        read_normalisation(tmp_path, SMALL)


@pytest.mark.slow
@pytest.mark.parametrize("dataset", ["beat", "show"])
def test_the_forward_pass_matches_the_released_network(
    dataset: Literal["beat", "show"], tmp_path: Path
) -> None:
    reference = reference_arrays(f"diffsheg_{dataset}")
    shapes = json.loads((REFERENCE / f"diffsheg_{dataset}_state_dict.json").read_text())
    torch.save({"encoder": reference_weights(shapes)}, tmp_path / "released.pt")
    if dataset == "beat":
        stats = REFERENCE.parent / "data" / "diffsheg_stats"
        network = load_network(tmp_path / "released.pt", dataset, stats)
        denoiser = network.model
        assert network.normalisation.mean.shape == (denoiser.config.motion_width,)
    else:
        denoiser = load_released(tmp_path / "released.pt", dataset)
    given = (reference[name] for name in ("noisy", "timestep", "mel", "hubert", "person"))
    expected = reference["eps"]
    with torch.inference_mode():
        result = denoiser(*given)
    assert float((result - expected).norm() / expected.norm()) < 1e-5
    assert float((result - expected).abs().max() / expected.abs().max()) < 1e-4


@pytest.mark.parametrize(("name", "save"), [("a.pt", torch.save), ("a.safetensors", save_file)])
@pytest.mark.parametrize("key", ["out.weight", "encoder.out.weight"])
def test_weights_are_read_from_both_kinds_of_file_and_under_the_key_encoder(
    name: str, save: Callable[..., None], key: str, tmp_path: Path
) -> None:
    save({key: torch.ones(2)}, tmp_path / name)
    assert read_weights(tmp_path / name)["out.weight"].tolist() == [1, 1]
