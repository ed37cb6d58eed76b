"""Spectra of speech, HuBERT's features of it, and vectors of its words."""

import json
import shutil
from pathlib import Path

import librosa
import numpy as np
import pytest
import torch
from safetensors.torch import load_file, save_file
from scipy.fft import dct

from motion.arrays import Floats32
from motion.audio import Audio
from motion.errors import InputError
from motion.formats.transcript import Word
from tests.support.sounds import noise, tone
from training.speech_features.hubert import load_hubert, resample_to_frames, stand_in
from training.speech_features.spectra import (
    BANDS,
    COEFFICIENTS,
    RATE,
    WIDTH,
    WINDOW,
    check_speech,
    filterbank,
    log_mel,
    mel_bands,
    mfcc,
)
from training.speech_features.word_vectors import StandIn, load_word_vectors, word_rows


def test_ten_seconds_give_998_rows_padded_with_zeros() -> None:
    rows = filterbank(tone(10).samples)
    padding = 9.173025 / (2 * 5.062332)
    assert tuple(rows.shape) == (1024, 128)
    assert rows[998:].numpy() == pytest.approx(padding)
    assert (rows[:998] != rows[998]).any(dim=1).all()


@pytest.mark.parametrize(
    ("samples", "message"),
    [(tone(0.3).samples, "0.30 s, too short"), (np.zeros(16_000, np.float32), "is silent")],
)
def test_samples_without_speech_are_refused(samples: Floats32, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_speech(samples)


@pytest.mark.parametrize("rate", [15, 30])
def test_bands_match_librosas_defaults(rate: int) -> None:
    speech = noise(2.0, RATE)
    theirs = librosa.feature.melspectrogram(
        y=speech.samples.astype(float), sr=RATE, n_fft=WINDOW, hop_length=RATE // rate, n_mels=BANDS
    )
    np.testing.assert_allclose(mel_bands(speech, rate), theirs.T[: 2 * rate], rtol=1e-4)


@pytest.mark.parametrize("frame_rate", [0, -15, 29.97])
def test_a_frame_rate_that_does_not_divide_the_sound_is_refused(frame_rate: float) -> None:
    with pytest.raises(InputError, match="such as 15 or 30"):
        mel_bands(noise(1.0, RATE), frame_rate)


NOISE = noise(2)


def test_a_frame_has_two_rows_of_coefficients_and_their_deltas() -> None:
    result = mfcc(NOISE, 15)
    assert result.shape == (30, WIDTH)
    rows = result.reshape(60, 3, COEFFICIENTS)
    bands = np.log10(mel_bands(NOISE, 30).astype(float))
    np.testing.assert_allclose(rows[:, 0], dct(bands, norm="ortho")[:, :14], atol=1e-4)
    np.testing.assert_allclose(rows[1:-1, 1], (rows[2:, 0] - rows[:-2, 0]) / 2, atol=1e-4)
    np.testing.assert_allclose(rows[2:-2, 2], (rows[3:-1, 1] - rows[1:-3, 1]) / 2, atol=1e-4)


def test_the_log_spectrogram_of_silence_is_finite() -> None:
    assert np.isfinite(mfcc(Audio(np.zeros(8000, np.float32), 16000), 15)).all()
    np.testing.assert_allclose(log_mel(NOISE, 15), np.log10(mel_bands(NOISE, 15)), rtol=1e-5)


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A network of HuBERT-large's width, but with few channels elsewhere."""
    from transformers import HubertConfig, HubertModel

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
def test_features_have_1024_channels_at_50_hertz(samples: int, vectors: int) -> None:
    assert stand_in().features(NOISE.samples[:samples]).shape == (vectors, 1024)


def test_the_stand_in_distinguishes_speech_but_not_loudness_and_is_deterministic() -> None:
    torch.manual_seed(3)
    expected = torch.rand(3)
    torch.manual_seed(3)
    hubert, plain = stand_in(), stand_in().features(NOISE.samples)
    assert torch.equal(torch.rand(3), expected)
    assert hubert.stands_in
    assert "stand-in" in hubert.description
    assert torch.equal(hubert.features(NOISE.samples), plain)
    quieter = hubert.features(np.float32(0.3) * NOISE.samples + np.float32(0.2))
    torch.testing.assert_close(plain, quieter, rtol=1e-3, atol=1e-3)
    assert float((plain - hubert.features(noise(2, seed=2).samples)).abs().mean()) > 0.01


def test_weights_from_a_folder_are_used_and_identified_by_their_hash(saved: Path) -> None:
    from transformers import HubertModel

    hubert = load_hubert(saved)
    assert not hubert.stands_in
    assert "hubert (sha256 " in hubert.description
    samples = NOISE.samples
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
def test_vectors_are_interpolated_to_frames_with_aligned_corners(vectors: int, frames: int) -> None:
    features = torch.randn(vectors, 4, generator=torch.Generator().manual_seed(1))
    expected = torch.nn.functional.interpolate(
        features.T[None], size=frames, mode="linear", align_corners=True
    )[0].T
    torch.testing.assert_close(resample_to_frames(features, frames), expected, rtol=1e-4, atol=1e-4)


WORDS = (Word("hello", 0.0, 0.2), Word("nobody", 0.2, 0.3), Word("hi", 0.35, 0.36))


def test_the_stand_in_is_deterministic_and_depends_on_spelling() -> None:
    result = StandIn().lookup(["walking", "walked", "sea"])
    again = StandIn().lookup(["walking"])
    assert result["walking"].shape == (300,)
    np.testing.assert_array_equal(result["walking"], again["walking"])
    near, far = (np.corrcoef(result["walking"], result[word])[0, 1] for word in ("walked", "sea"))
    assert near > 0.2 > far


def test_fasttext_vectors_are_read_for_the_requested_words(tmp_path: Path) -> None:
    path = tmp_path / "wiki.vec"
    path.write_text("3 2\nhello 1 2\nbroken 1\nhi 3 4\n")
    vectors = load_word_vectors(path)
    assert vectors.width == 2
    assert vectors.description.startswith("wiki.vec (sha256 ")
    rows = word_rows(WORDS, vectors, 6, 15.0)
    np.testing.assert_array_equal(rows, [[1, 2], [1, 2], [1, 2], [0, 0], [0, 0], [3, 4]])
    with pytest.raises(InputError, match="line 3: the line holds no vector of 2 numbers"):
        vectors.lookup(["broken"])
    path.write_text("1 2\nhello 2 1\n")
    assert load_word_vectors(path).description != vectors.description


@pytest.mark.parametrize("content", ["", "hello 1 2\n", "0 0\n"])
def test_a_file_without_vectors_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "a.vec").write_text(content)
    with pytest.raises(InputError, match="holds no word vectors"):
        load_word_vectors(tmp_path / "a.vec")
