"""The authors' released network."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file
from torch import Tensor

from generators.diffsheg import load_released
from generators.diffsheg.network_file import load_network, read_weights
from motion.errors import InputError
from tests.generators.reference_weights import REFERENCE, reference_weights


@pytest.mark.slow
@pytest.mark.parametrize("dataset", ["beat", "show"])
def test_the_forward_pass_is_that_of_the_released_network(dataset: str, tmp_path: Path) -> None:
    names = REFERENCE / f"diffsheg_{dataset}_state_dict.json"
    if not names.exists():
        pytest.skip("the reference of the released network is not here")
    shapes = json.loads(names.read_text())
    weights = reference_weights(shapes)
    torch.save({"encoder": weights}, tmp_path / "released.pt")
    denoiser = load_released(tmp_path / "released.pt", dataset=dataset)
    if dataset == "beat":
        stats = REFERENCE.parent / "data" / "diffsheg_stats"
        network = load_network(tmp_path / "released.pt", dataset, stats)
        assert network.normalisation.mean.shape == (denoiser.config.motion_width,)
    with np.load(REFERENCE / f"diffsheg_{dataset}.npz") as known, torch.inference_mode():
        noisy, timestep, mel, hubert, person, expected = (
            torch.from_numpy(known[name])
            for name in ("noisy", "timestep", "mel", "hubert", "person", "eps")
        )
        found = denoiser(noisy, timestep, mel, hubert, person)
    assert float((found - expected).norm() / expected.norm()) < 1e-5
    assert float((found - expected).abs().max() / expected.abs().max()) < 1e-4


def _saved(weights: dict[str, Tensor], path: Path) -> Path:
    if path.suffix == ".safetensors":
        save_file(weights, path)
    else:
        torch.save(weights, path)
    return path


@pytest.mark.parametrize("name", ["net.pt", "net.safetensors"])
def test_weights_are_read_from_both_kinds_of_file_also_under_the_key_encoder(
    name: str, tmp_path: Path
) -> None:
    for key in ("out.weight", "encoder.out.weight"):
        file = _saved({key: torch.ones(2)}, tmp_path / name)
        assert read_weights(file)["out.weight"].tolist() == [1, 1]


def test_another_network_is_refused_with_the_weights_that_do_not_fit(tmp_path: Path) -> None:
    file = _saved({"encoder_exp.out.bias": torch.ones(7)}, tmp_path / "net.pt")
    with pytest.raises(InputError, match=r"missing .*of another shape .*\(7,\) instead of \(51,\)"):
        load_released(file, dataset="beat")


class _Trap:
    def __reduce__(self) -> tuple[object, tuple[Path, str]]:
        return Path.write_text, (Path("sprung"), "yes")


def test_a_pickle_that_runs_code_is_refused_unrun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "net.pt").write_bytes(pickle.dumps({"encoder": _Trap()}, protocol=2))
    with pytest.raises(InputError, match="not a file of network weights"):
        load_released(tmp_path / "net.pt")
    assert not Path("sprung").exists()


@pytest.mark.parametrize("content", [b"", b"no network", b"\x80\x02garbage"])
def test_a_file_that_is_no_checkpoint_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "net.pt").write_bytes(content)
    with pytest.raises(InputError, match="not a file of network weights"):
        load_released(tmp_path / "net.pt")


def test_a_checkpoint_that_is_not_there_and_an_unknown_dataset_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        load_released(tmp_path / "net.pt")
    with pytest.raises(InputError, match="not released for 'ted'"):
        load_released(tmp_path / "net.pt", dataset="ted")
