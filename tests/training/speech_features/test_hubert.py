"""HuBERT is loaded from a complete folder; its stand-in is named as one."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from safetensors.torch import load_file, save_file
from transformers import HubertConfig, HubertModel

from motion.errors import InputError
from training.speech_features.hubert import load_hubert, resample_to_frames, stand_in


def speech(seconds: float) -> NDArray[np.float32]:
    rng = np.random.default_rng(4)
    return (0.1 * rng.standard_normal(round(seconds * 16000))).astype(np.float32)


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A network of HuBERT-large's width, but with few channels elsewhere."""
    folder = tmp_path_factory.mktemp("models") / "hubert"
    config = HubertConfig(
        hidden_size=1024,
        num_hidden_layers=1,
        num_attention_heads=4,
        intermediate_size=16,
        conv_dim=(8,) * 7,
        num_conv_pos_embeddings=8,
        num_conv_pos_embedding_groups=16,
        feat_extract_norm="layer",
        conv_bias=True,
        do_stable_layer_norm=True,
    )
    HubertModel(config).save_pretrained(folder)
    return folder


@pytest.mark.parametrize(
    ("samples", "vectors"), [(0, 1), (399, 1), (400, 1), (720, 2), (16000, 49)]
)
def test_there_are_1024_channels_50_times_a_second(samples: int, vectors: int) -> None:
    assert stand_in().features(speech(1)[:samples]).shape == (vectors, 1024)


def test_the_stand_in_tells_speech_apart_but_not_its_loudness_and_takes_no_chance() -> None:
    torch.manual_seed(3)
    expected = torch.rand(3)
    torch.manual_seed(3)
    hubert, plain = stand_in(), stand_in().features(speech(1))
    assert torch.equal(torch.rand(3), expected)
    assert hubert.stands_in
    assert "stand-in" in hubert.description
    assert torch.equal(hubert.features(speech(1)), plain)
    quieter = hubert.features(np.float32(0.3) * speech(1) + np.float32(0.2))
    torch.testing.assert_close(plain, quieter, rtol=1e-3, atol=1e-3)
    assert float((plain - hubert.features(speech(2)[16000:])).abs().mean()) > 0.01


def test_weights_of_a_folder_are_heard_with_and_named_by_their_hash(saved: Path) -> None:
    hubert = load_hubert(saved)
    assert not hubert.stands_in
    assert "hubert (sha256 " in hubert.description
    samples = speech(1)
    even = torch.from_numpy((samples - samples.mean()) / samples.std())[None]
    with torch.inference_mode():
        expected = HubertModel.from_pretrained(saved).eval()(even).last_hidden_state[0]
    torch.testing.assert_close(hubert.features(samples), expected, rtol=1e-3, atol=1e-4)


def test_a_folder_that_lacks_a_weight_is_refused(saved: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(saved, tmp_path / "hubert")
    weights = load_file(folder / "model.safetensors")
    weights.pop("encoder.layers.0.attention.k_proj.weight")
    save_file(weights, folder / "model.safetensors", metadata={"format": "pt"})
    with pytest.raises(InputError, match=r"lacks 1 weights \(encoder.layers.0.attention.k_proj"):
        load_hubert(folder)


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("config.json", None, r"config\.json.*save_pretrained"),
        ("model.safetensors", None, r"model\.safetensors.*save_pretrained"),
        ("config.json", {"hidden_size": 768}, "768 channels"),
        ("config.json", {"model_type": "wav2vec2"}, "type 'wav2vec2'"),
    ],
)
def test_a_folder_without_a_file_or_of_another_network_is_refused(
    saved: Path, tmp_path: Path, name: str, change: dict[str, object] | None, message: str
) -> None:
    path = shutil.copytree(saved, tmp_path / "hubert") / name
    if change is None:
        path.unlink()
    else:
        path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(InputError, match=message):
        load_hubert(path.parent)


@pytest.mark.parametrize(("vectors", "frames"), [(49, 15), (498, 149), (7, 1), (1, 4), (3, 20)])
def test_vectors_come_to_frames_linearly_with_aligned_corners(vectors: int, frames: int) -> None:
    features = torch.randn(vectors, 4, generator=torch.Generator().manual_seed(1))
    expected = torch.nn.functional.interpolate(
        features.T[None], size=frames, mode="linear", align_corners=True
    )[0].T
    torch.testing.assert_close(resample_to_frames(features, frames), expected, rtol=1e-4, atol=1e-4)
