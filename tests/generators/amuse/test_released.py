"""The authors' released networks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor

from generators.amuse import load_released
from motion.errors import InputError
from tests.generators.reference_weights import REFERENCE, reference_weights

pytestmark = pytest.mark.skipif(
    not (REFERENCE / "amuse.npz").exists(), reason="the reference of the released network is absent"
)


def _known(name: str) -> dict[str, Tensor]:
    with np.load(REFERENCE / name) as arrays:
        return {key: torch.from_numpy(np.asarray(arrays[key])) for key in arrays}


def _motion_weights() -> dict[str, dict[str, Tensor]]:
    shapes = json.loads((REFERENCE / "amuse_state_dict.json").read_text())
    return {part: reference_weights(shapes[part]) for part in ("prior", "denoiser")}


@pytest.fixture(scope="module")
def motion_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("amuse") / "prior.pt"
    torch.save(_motion_weights(), file)
    return file


def _error(found: Tensor, expected: Tensor) -> float:
    assert found.shape == expected.shape
    return float((found - expected).abs().max() / expected.abs().max())


def test_prior_and_denoiser_compute_what_the_released_networks_do(motion_file: Path) -> None:
    released, known = load_released(prior=motion_file), _known("amuse.npz")
    with torch.inference_mode():
        mu, std = released.encode(known["motion"])
        decoded = released.decode(known["z"])
        conditions = (known[name] for name in ("content", "emotion", "style"))
        eps = released.denoise(known["z"], known["timestep"], *conditions)
    assert _error(mu, known["mu"]) < 1e-5
    assert _error(std, known["std"]) < 1e-5
    assert _error(decoded, known["decoded"]) < 1e-5
    assert _error(eps, known["eps"]) < 1e-5


@pytest.mark.slow
def test_the_speech_model_computes_what_the_released_one_does(tmp_path: Path) -> None:
    shapes = json.loads((REFERENCE / "amuse_audio_state_dict.json").read_text())
    torch.save(reference_weights(shapes), tmp_path / "speech.pt")
    released, known = load_released(speech=tmp_path / "speech.pt"), _known("amuse_audio.npz")
    with torch.inference_mode():
        heard = released.encode_speech(known["filterbank"])
    for name, found in heard._asdict().items():
        assert _error(found, known[name]) < 1e-4, name


def test_a_network_whose_file_was_not_named_is_asked_for_by_name() -> None:
    with pytest.raises(InputError, match=r"not loaded.*load_released\(speech=FILE\)"):
        load_released().encode_speech(torch.zeros(1, 1024, 128))


def test_a_file_of_the_prior_alone_is_refused(tmp_path: Path) -> None:
    torch.save(_motion_weights()["prior"], tmp_path / "prior.pt")
    with pytest.raises(InputError, match="it has no 'prior' and 'denoiser'"):
        load_released(prior=tmp_path / "prior.pt")


def test_another_network_is_refused_with_the_weights_that_do_not_fit(tmp_path: Path) -> None:
    weights = _motion_weights()
    weights["prior"]["final_layer.bias"] = torch.zeros(282)
    torch.save(weights, tmp_path / "prior.pt")
    with pytest.raises(InputError, match=r"not AMUSE's motion prior: .*\(282,\) instead of \(333,"):
        load_released(prior=tmp_path / "prior.pt")
    with pytest.raises(InputError, match=r"not AMUSE's speech model: .* missing"):
        torch.save({"other.weight": torch.zeros(2)}, tmp_path / "speech.pt")
        load_released(speech=tmp_path / "speech.pt")
