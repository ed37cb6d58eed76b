"""An audio spectrogram transformer: its initial weights and its augmentation."""

import json
from pathlib import Path

import pytest
import torch

from generators.amuse.config import SPEECH_PRESETS
from generators.amuse.speech import SpeechEncoder, ast_config
from motion.errors import InputError
from tests.generators.amuse.small_networks import SMALL_SPEECH as SMALL
from training.layers.transformers import PackedLinear, pack
from training.speech_features.spectrogram_transformer import (
    MASKED_BANDS,
    MASKED_ROWS,
    augment,
    initialise_from_speech,
    read_ast_weights,
)


def test_an_image_network_is_converted_to_one_for_sound(tmp_path: Path) -> None:
    from transformers import DeiTConfig, DeiTModel

    sizes = DeiTConfig(
        hidden_size=SMALL.width,
        num_hidden_layers=SMALL.layers,
        num_attention_heads=SMALL.heads,
        intermediate_size=SMALL.feed_forward,
        image_size=48,
    )
    model = DeiTModel(sizes, add_pooling_layer=False)
    torch.nn.init.normal_(model.embeddings.position_embeddings)
    model.save_pretrained(tmp_path)
    weights = read_ast_weights(tmp_path, ast_config(SMALL))
    SpeechEncoder(SMALL).transformer.load_state_dict(weights)
    colours = model.embeddings.patch_embeddings.projection.weight
    torch.testing.assert_close(
        weights["embeddings.patch_embeddings.projection.weight"], colours.sum(1, keepdim=True)
    )
    # Of 3 rows of patches the first 2 are the middle; 3 columns are stretched to 4.
    own, fitted = model.embeddings.position_embeddings, weights["embeddings.position_embeddings"]
    torch.testing.assert_close(fitted[:, :2], own[:, :2])
    assert fitted.shape == (1, 2 + 2 * 4, SMALL.width)
    torch.testing.assert_close(fitted[:, 2], own[:, 2])
    torch.testing.assert_close(fitted[:, 5], own[:, 4])


def test_another_size_or_architecture_is_refused_with_the_difference(tmp_path: Path) -> None:
    from transformers import ASTConfig, ASTModel

    ASTModel(ASTConfig(hidden_size=8, num_hidden_layers=1, num_attention_heads=2)).save_pretrained(
        tmp_path
    )
    with pytest.raises(InputError, match=r"another size.*hidden_size 8 instead of 24"):
        read_ast_weights(tmp_path, ast_config(SMALL))
    (tmp_path / "config.json").write_text(json.dumps({"model_type": "bert"}))
    with pytest.raises(InputError, match="a network of type 'bert', not an AST or a DeiT"):
        read_ast_weights(tmp_path, ast_config(SMALL))


def test_a_speech_encoder_responds_to_the_time_of_a_sound() -> None:
    torch.manual_seed(3)
    config = SPEECH_PRESETS["tiny"].network
    encoder = SpeechEncoder(config).eval()
    early = torch.zeros(1, config.frames, config.bands)
    early[:, 16:32] = 3.0
    late = early.roll(10 * 16, dims=1)
    with torch.inference_mode():
        before = (encoder(early)[0] - encoder(late)[0]).abs().max()
        initialise_from_speech(encoder.transformer, torch.randn(4, config.frames, config.bands))
        after = (encoder(early)[0] - encoder(late)[0]).abs().max()
    assert before < 1e-4
    assert after > 1e-2


def test_masks_keep_their_share_and_are_the_same_for_both() -> None:
    torch.manual_seed(2)
    filterbanks = torch.ones(40, 1024, 128)
    masked, target = augment(filterbanks)
    hidden = target == 0
    rows, bands = hidden.all(dim=2).sum(dim=1), hidden.all(dim=1).sum(dim=1)
    assert int(rows.max()) <= round(MASKED_ROWS * 1024)
    assert int(bands.max()) <= round(MASKED_BANDS * 128)
    assert int(rows.max()) > 0
    assert int(bands.max()) > 0
    # The input is noisy by a tenth at most, and shifted.
    assert float((masked.sum() - target.sum()) / masked.numel()) < 0.1
    assert float(masked.max()) <= 1.1


def test_a_packed_transformer_gives_the_same_output() -> None:
    torch.manual_seed(2)
    model = SpeechEncoder(SMALL).transformer.eval().requires_grad_(False)
    filterbanks = torch.randn(3, SMALL.frames, SMALL.bands)
    with torch.inference_mode():
        before = model(filterbanks).last_hidden_state
        pack(model)
        after = model(filterbanks).last_hidden_state
    assert torch.allclose(before, after, atol=1e-5)
    assert any(isinstance(one, PackedLinear) for one in model.modules())
