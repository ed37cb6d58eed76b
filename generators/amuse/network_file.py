"""AMUSE's networks with all that motion depends on, from our files or from its authors'.

``released_names.toml`` translates the authors' names of the weights into ours. Weights that their
code never uses are excluded by name, and every other weight must have a place in our networks.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import torch
from torch import Tensor

from generators.amuse.config import LABELS, MotionConfig, SpeechConfig
from generators.amuse.model import MotionModel
from generators.amuse.speech import AnySpeechModel, SpeechModel, make_speech_model
from motion.errors import InputError, listed
from training.released_weights import ReleasedNames, fill, not_weights_error, read_saved, tensors_in
from training.weights_file import NetworkKind, TrainedNetwork, holds_facts

_MOTION: Final = NetworkKind(name="amuse motion", wanted="AMUSE's motion prior and denoiser")
_SPEECH: Final = NetworkKind(name="amuse speech", wanted="AMUSE's speech model")
_REMEDY: Final = "Give the released checkpoint, or its state dictionary as torch.save writes it"

_NAMES: Final = ReleasedNames.read(Path(__file__).with_name("released_names.toml"))

MotionNetworks = TrainedNetwork[MotionModel]
"""The motion prior and the denoiser."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpeechNetwork(TrainedNetwork[AnySpeechModel]):
    """The network that disentangles speech.

    Attributes
    ----------
    latents : mapping of str to (mapping of str to Tensor)
        Under ``emotion`` and ``style``, the mean latent (latent,) of each training emotion and
        speaker; empty if unknown, as for a released network.
    """

    latents: Mapping[str, Mapping[str, Tensor]] = field(default_factory=dict)

    def labelled(self, part: str, label: str) -> Tensor:
        """Return the mean latent (latent,) of an emotion, or of a speaker's style.

        Raises
        ------
        InputError
            If the network did not learn it.
        """
        known = self.latents.get(part, {})
        if label not in known:
            names = f"it learned {listed(list(known))}" if known else "it has no names"
            raise InputError(
                f"the speech model learned no {part} {label!r}: {names}",
                remedy=f'Name a recording instead: {part} = "FILE.wav"',
            )
        return known[label]


def write_motion(path: Path, networks: MotionNetworks) -> None:
    """Write prior and denoiser to one safetensors file, with their sizes and their origin."""
    _MOTION.write(path, networks)


def write_speech(path: Path, network: SpeechNetwork) -> None:
    """Write a speech model to one safetensors file, with its sizes, its labels and its origin."""
    latents = {
        f"{part}.{label}": latent
        for part, latents in network.latents.items()
        for label, latent in latents.items()
    }
    _SPEECH.write(path, network, "model", latents)


def load_motion(path: Path) -> MotionNetworks:
    """Return the networks of a file that `write_motion` or AMUSE's authors wrote.

    Raises
    ------
    InputError
        If the file has no such networks.
    """
    if not holds_facts(path):
        return MotionNetworks(model=read_motion_model(path))
    with _MOTION.reading(path) as file:
        model = file.loaded(MotionModel(MotionConfig(**file.facts["config"])))
        return MotionNetworks(model=model, training=file.facts["training"])


def load_speech(path: Path) -> SpeechNetwork:
    """Return the network of a file that `write_speech` or AMUSE's authors wrote.

    Raises
    ------
    InputError
        If the file has no such network.
    """
    if not holds_facts(path):
        return SpeechNetwork(model=read_speech_model(path))
    with _SPEECH.reading(path) as file:
        return SpeechNetwork(
            model=file.loaded(make_speech_model(SpeechConfig(**file.facts["config"])), "model"),
            latents={part: latents for part in LABELS if (latents := file.with_prefix(part))},
            training=file.facts["training"],
        )


def read_motion_model(file: Path) -> MotionModel:
    """Return the released networks, saved under the names ``prior`` and ``denoiser``."""
    content = read_saved(file)
    if not isinstance(content, Mapping) or not {"prior", "denoiser"} <= content.keys():
        raise not_weights_error(file, "it has no 'prior' and 'denoiser'")
    model = MotionModel(MotionConfig(clip=1.0))
    for part, description in (("prior", "motion prior"), ("denoiser", "latent denoiser")):
        weights = _forward_pass_weights(content[part], file)
        fill(model.get_submodule(part), weights, file, f"AMUSE's {description}", _REMEDY)
    return model.eval()


def read_speech_model(file: Path) -> SpeechModel:
    """Return the released speech model, saved as a state dictionary."""
    weights = _forward_pass_weights(read_saved(file), file)
    for name in [name for name in weights if ".attn.qkv." in name]:
        for letter, part in zip("qkv", weights.pop(name).chunk(3), strict=True):
            weights[name.replace(".attn.qkv.", f".attention.{letter}_proj.")] = part.clone()
    with torch.device("meta"):
        model = SpeechModel(SpeechConfig())
    return fill(model, weights, file, "AMUSE's speech model", _REMEDY)


def _forward_pass_weights(content: object, file: Path) -> dict[str, Tensor]:
    """Return the weights of the release's own forward pass, by our names."""
    weights = _NAMES.renamed_weights(tensors_in(content, file))
    # Our positions have one row per token; the release's also have a batch dimension.
    return {
        name: weight.squeeze(1) if name.endswith(".pe") else weight
        for name, weight in weights.items()
    }
