"""Loading the networks that AMUSE's authors released.

Their names for the weights are translated into ours one by one. What their code never asks is left
out by name, and every other weight must find its place.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

import torch
from torch import Tensor

from generators.amuse.config import AMUSE, SPEECH
from generators.amuse.model import Gaussian, MotionModel
from generators.amuse.speech import HeardSpeech, SpeechModel
from motion.errors import InputError
from training.released_weights import fill, not_weights, read_saved, renamed, tensors_in

Network = TypeVar("Network")

_REMEDY: Final = "Give the released checkpoint, or what torch.save wrote of its state dictionary"

_DENOISER: Final = (
    (r"^time_embedding\.linear_1\.", "time_embedding.0."),
    (r"^time_embedding\.linear_2\.", "time_embedding.2."),
    (r"^emb_proj_con\.", "content."),
    (r"^emb_proj_emo\.", "emotion."),
    (r"^emb_proj_sty\.", "style."),
)

_SPEECH: Final = (
    (r"^emo_enc\.", "emotion."),
    (r"^sty_enc\.", "style."),
    (r"^con_enc\.", "content."),
    (r"\.mlp_head_featbased\.", ".class_head."),
    (r"\.v\.cls_token$", ".transformer.embeddings.cls_token"),
    (r"\.v\.dist_token$", ".transformer.embeddings.distillation_token"),
    (r"\.v\.pos_embed$", ".transformer.embeddings.position_embeddings"),
    (r"\.v\.patch_embed\.proj\.", ".transformer.embeddings.patch_embeddings.projection."),
    (r"\.v\.norm\.", ".transformer.layernorm."),
    (r"\.v\.blocks\.(\d+)\.attn\.proj\.", r".transformer.layers.\1.attention.o_proj."),
    (r"\.v\.blocks\.(\d+)\.norm1\.", r".transformer.layers.\1.layernorm_before."),
    (r"\.v\.blocks\.(\d+)\.norm2\.", r".transformer.layers.\1.layernorm_after."),
    (r"\.v\.blocks\.(\d+)\.", r".transformer.layers.\1."),
    (r"^fusion\.fc\.", "decoder.narrow."),
    (r"^fusion\.", "decoder.fusion."),
    (r"^decode\.projection\.", "decoder.projection."),
    (r"^decode\.", "decoder.decoder."),
)
"""Patterns of the release's names and what they are here, applied in order."""

_UNUSED: Final = re.compile(r"^mem_pos\.|^fusion_ablation\.|\.mlp_head\.")
"""Weights in the release's files that its own forward pass never asks."""


@dataclass(frozen=True, eq=False)
class Released:
    """The released networks, each there if its file was named.

    Attributes
    ----------
    motion : MotionModel or None
    speech : SpeechModel or None
        Both in evaluation mode, on the CPU.
    """

    motion: MotionModel | None
    speech: SpeechModel | None

    def encode(self, motion: Tensor) -> Gaussian:
        """Return ``(mu, std)`` of the latent of normalised motion (batch, 300, 333)."""
        return _loaded(self.motion, "prior").prior.encode(motion)

    def decode(self, z: Tensor) -> Tensor:
        """Return the normalised motion (batch, 300, 333) of latents (batch, 1, 128)."""
        return _loaded(self.motion, "prior").prior.decode(z)

    def denoise(
        self, z: Tensor, timestep: Tensor | int, content: Tensor, emotion: Tensor, style: Tensor
    ) -> Tensor:
        """Return the noise in latents `z` (batch, 1, 128); see `Denoiser.forward`."""
        denoiser = _loaded(self.motion, "prior").denoiser
        found: Tensor = denoiser(z, torch.as_tensor(timestep), content, emotion, style)
        return found

    def encode_speech(self, filterbank: Tensor) -> HeardSpeech:
        """Return what is heard in standardised filterbanks (batch, 1024, 128)."""
        heard: HeardSpeech = _loaded(self.speech, "speech")(filterbank)
        return heard


def load_released(prior: str | Path | None = None, speech: str | Path | None = None) -> Released:
    """Return the released networks, ready to be asked.

    Parameters
    ----------
    prior : path, optional
        What ``torch.save({"prior": state_dict, "denoiser": state_dict})`` wrote.
    speech : path, optional
        What ``torch.save`` or safetensors wrote of the speech model's state dictionary.

    Raises
    ------
    InputError
        If a file cannot be read, or is another network's: it names the weights that are missing,
        unknown or of another shape.
    """
    return Released(
        motion=None if prior is None else read_motion_model(Path(prior)),
        speech=None if speech is None else read_speech_model(Path(speech)),
    )


def read_motion_model(file: Path) -> MotionModel:
    """Return the released prior and denoiser; see `load_released`."""
    found = read_saved(file)
    if not isinstance(found, Mapping) or not {"prior", "denoiser"} <= found.keys():
        raise not_weights(file, "it has no 'prior' and 'denoiser'")
    model = MotionModel(AMUSE)
    for part, network, patterns, whose in (
        ("prior", model.prior, (), "AMUSE's motion prior"),
        ("denoiser", model.denoiser, _DENOISER, "AMUSE's latent denoiser"),
    ):
        # A position is one row for each token; the release keeps a dimension for the batch.
        weights = {
            name: weight.squeeze(1) if name.endswith(".pe") and weight.ndim == 3 else weight
            for name, weight in renamed(_asked(found[part], file), patterns).items()
        }
        fill(network, weights, file, whose, _REMEDY)
    return model.eval()


def read_speech_model(file: Path) -> SpeechModel:
    """Return the released speech model; see `load_released`."""
    weights = renamed(_asked(read_saved(file), file), _SPEECH)
    for name in [name for name in weights if ".attn.qkv." in name]:
        for one, part in zip("qkv", weights.pop(name).chunk(3), strict=True):
            weights[name.replace(".attn.qkv.", f".attention.{one}_proj.")] = part.clone()
    with torch.device("meta"):
        model = SpeechModel(SPEECH)
    return fill(model, weights, file, "AMUSE's speech model", _REMEDY)


def _asked(found: object, file: Path) -> dict[str, Tensor]:
    """Return the weights that the release's own forward pass asks."""
    weights = tensors_in(found, file)
    return {name: weight for name, weight in weights.items() if not _UNUSED.search(name)}


def _loaded(network: Network | None, which: str) -> Network:
    if network is None:
        raise InputError(
            "this network was not loaded", remedy=f"Name its file: load_released({which}=FILE)"
        )
    return network
