"""AMUSE's networks with all that motion depends on, from our files or the authors'."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from torch import Tensor

from generators.amuse.config import MotionConfig, SpeechConfig
from generators.amuse.model import Denoiser, MotionPrior, NoPrior, prior_of
from generators.amuse.released import read_motion_networks, read_speech_model
from generators.amuse.speech import AnySpeechModel, speech_model_of
from motion.errors import InputError
from motion.listing import listed
from training.weights_file import holding, holds_facts, read_weights, tensors_of, write_weights

_MOTION: Final = "amuse motion"
_SPEECH: Final = "amuse speech"


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionNetworks:
    """The two networks that tell motion.

    Attributes
    ----------
    prior : MotionPrior or NoPrior
    denoiser : Denoiser
        In evaluation mode, on the CPU.
    training : mapping
        How they were trained, as JSON values; empty where nobody knows.
    """

    prior: MotionPrior | NoPrior
    denoiser: Denoiser
    training: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True, eq=False)
class SpeechNetwork:
    """The network that takes speech apart.

    Attributes
    ----------
    model : SpeechModel or SpeechAutoencoder
        In evaluation mode, on the CPU.
    latents : mapping of str to (mapping of str to Tensor)
        Under ``emotion`` and ``style`` the mean latent (latent,) of each emotion and speaker that
        it learned from; empty where nobody knows, as of a released network.
    training : mapping
        How it was trained, as JSON values; empty where nobody knows.
    """

    model: AnySpeechModel
    latents: Mapping[str, Mapping[str, Tensor]] = field(default_factory=dict)
    training: Mapping[str, Any] = field(default_factory=dict)

    def labelled(self, part: str, label: str) -> Tensor:
        """Return the mean latent (latent,) of an emotion, or of a speaker's style.

        Raises
        ------
        InputError
            If the network did not learn it.
        """
        known = self.latents.get(part, {})
        if label not in known:
            names = f"it knows {listed(list(known))}" if known else "it knows none by name"
            raise InputError(
                f"the speech model learned no {part} {label!r}: {names}",
                remedy=f'Name a recording instead: {part} = "FILE.wav"',
            )
        return known[label]


def write_motion_networks(path: Path, networks: MotionNetworks) -> None:
    """Write prior and denoiser to one safetensors file, with their sizes and their origin."""
    tensors = tensors_of({"prior": networks.prior, "denoiser": networks.denoiser})
    facts = {
        "network": _MOTION,
        "config": asdict(networks.prior.config),
        "training": dict(networks.training),
    }
    write_weights(path, tensors, facts)


def write_speech_network(path: Path, network: SpeechNetwork) -> None:
    """Write a speech model to one safetensors file, with its sizes, its labels and its origin."""
    tensors = tensors_of({"model": network.model})
    for part, latents in network.latents.items():
        tensors |= {f"{part}.{label}": latent for label, latent in latents.items()}
    facts = {
        "network": _SPEECH,
        "config": asdict(network.model.config),
        "labels": {part: list(latents) for part, latents in network.latents.items()},
        "training": dict(network.training),
    }
    write_weights(path, tensors, facts)


def load_motion_networks(path: Path) -> MotionNetworks:
    """Return the networks of a file that `write_motion_networks` or AMUSE's authors wrote.

    Raises
    ------
    InputError
        If the file is no such network.
    """
    if not holds_facts(path):
        prior, denoiser = read_motion_networks(path)
        return MotionNetworks(prior=prior, denoiser=denoiser)
    file = read_weights(path)
    with _looking(path, "motion prior and denoiser"):
        config = MotionConfig(**file.config(_MOTION))
        return MotionNetworks(
            prior=file.loaded(prior_of(config), "prior"),
            denoiser=file.loaded(Denoiser(config), "denoiser"),
            training=file.facts["training"],
        )


def load_speech_network(path: Path) -> SpeechNetwork:
    """Return the network of a file that `write_speech_network` or AMUSE's authors wrote.

    Raises
    ------
    InputError
        If the file is no such network.
    """
    if not holds_facts(path):
        return SpeechNetwork(model=read_speech_model(path))
    file = read_weights(path)
    with _looking(path, "speech model"):
        config = SpeechConfig(**file.config(_SPEECH))
        return SpeechNetwork(
            model=file.loaded(speech_model_of(config), "model"),
            latents={
                part: {label: file.tensors[f"{part}.{label}"] for label in labels}
                for part, labels in file.facts["labels"].items()
            },
            training=file.facts["training"],
        )


def _looking(path: Path, wanted: str) -> AbstractContextManager[None]:
    remedy = f"Give AMUSE's {wanted}: one that was trained here, or the released one"
    return holding(path, f"AMUSE's {wanted}", remedy)
