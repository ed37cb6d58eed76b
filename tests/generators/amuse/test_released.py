"""The authors' released networks."""

import json
from pathlib import Path

import pytest
import torch
from torch import Tensor

from generators.amuse.network_file import load_motion, load_speech
from generators.amuse.speech import SpeechModel
from motion.errors import InputError
from tests.generators.reference_weights import REFERENCE, reference_arrays, reference_weights


def _error(found: Tensor, expected: Tensor) -> float:
    assert found.shape == expected.shape
    return float((found - expected).abs().max() / expected.abs().max())


def test_prior_and_denoiser_match_the_released_networks(tmp_path: Path) -> None:
    reference = reference_arrays("amuse")
    shapes = json.loads((REFERENCE / "amuse_state_dict.json").read_text())
    weights = {part: reference_weights(shapes[part]) for part in ("prior", "denoiser")}
    torch.save(weights, tmp_path / "prior.pt")
    released = load_motion(tmp_path / "prior.pt").model
    conditions = [reference[name] for name in ("content", "emotion", "style")]
    with torch.inference_mode():
        mu, std = released.prior.encode(reference["motion"])
        decoded = released.prior.decode(reference["z"])
        eps = released.denoiser(reference["z"], reference["timestep"], *conditions)
        latent = released.sample(reference["z"], conditions)
    for name, result in {"mu": mu, "std": std, "decoded": decoded, "eps": eps}.items():
        assert _error(result, reference[name]) < 1e-5, name
    # The release's scheduler limits what each step estimates to 1; a little noise is left.
    assert float(latent.abs().max()) < 1.2


@pytest.mark.slow
def test_the_speech_model_matches_the_released_one(tmp_path: Path) -> None:
    reference = reference_arrays("amuse_audio")
    shapes = json.loads((REFERENCE / "amuse_audio_state_dict.json").read_text())
    # Each encoder takes seconds, and all three are read and computed alike: one is.
    others = ("con_enc.", "emo_enc.")
    drawn = {name: shape for name, shape in shapes.items() if not name.startswith(others)}
    empty = {name: torch.zeros(()).expand(shapes[name]) for name in shapes.keys() - drawn}
    torch.save(reference_weights(drawn) | empty, tmp_path / "speech.pt")
    model = load_speech(tmp_path / "speech.pt").model
    assert isinstance(model, SpeechModel)
    with torch.inference_mode():
        style, logits = model.style(reference["filterbank"])
        rebuilt = model.decoder(*(reference[name] for name in ("content", "emotion", "style")))
    results = {"style": style, "style_logits": logits, "reconstruction": rebuilt}
    for name, result in results.items():
        assert _error(result, reference[name]) < 1e-4, name


def test_another_network_is_refused_with_its_mismatched_weights(tmp_path: Path) -> None:
    part = {"final_layer.bias": torch.zeros(282)}
    torch.save(part, tmp_path / "alone.pt")
    with pytest.raises(InputError, match="it has no 'prior' and 'denoiser'"):
        load_motion(tmp_path / "alone.pt")
    torch.save({"prior": part, "denoiser": part}, tmp_path / "prior.pt")
    with pytest.raises(InputError, match=r"not AMUSE's motion prior: Missing key"):
        load_motion(tmp_path / "prior.pt")
    torch.save({"other.weight": torch.zeros(2)}, tmp_path / "speech.pt")
    with pytest.raises(InputError, match=r"not AMUSE's speech model: Missing key"):
        load_speech(tmp_path / "speech.pt")
