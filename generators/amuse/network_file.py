"""AMUSE's networks with all that motion depends on, from our files or the authors'."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from torch import Tensor

from generators.amuse.config import MotionConfig, SpeechConfig
from generators.amuse.model import MotionModel
from generators.amuse.released import read_motion_model, read_speech_model
from generators.amuse.speech import AnySpeechModel, speech_model_of
from motion.errors import InputError
from motion.listing import listed
from training.weights_file import NetworkKind, holds_facts


def _kind(name: str, wanted: str) -> NetworkKind:
    remedy = f"Give AMUSE's {wanted}: one that was trained here, or the released one"
    return NetworkKind(name=f"amuse {name}", wanted=f"AMUSE's {wanted}", remedy=remedy)


_MOTION: Final = _kind("motion", "motion prior and denoiser")
_SPEECH: Final = _kind("speech", "speech model")


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionNetworks:
    """The two networks that tell motion.

    Attributes
    ----------
    model : MotionModel
        In evaluation mode, on the CPU.
    training : mapping
        How they were trained, as JSON values; empty where nobody knows.
    """

    model: MotionModel
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
    model = networks.model
    parts = dict(model.named_children())
    _MOTION.write(path, parts, model.config, training=dict(networks.training))


def write_speech_network(path: Path, network: SpeechNetwork) -> None:
    """Write a speech model to one safetensors file, with its sizes, its labels and its origin."""
    _SPEECH.write(
        path,
        {"model": network.model},
        network.model.config,
        {
            f"{part}.{label}": latent
            for part, latents in network.latents.items()
            for label, latent in latents.items()
        },
        labels={part: list(latents) for part, latents in network.latents.items()},
        training=dict(network.training),
    )


def load_motion_networks(path: Path) -> MotionNetworks:
    """Return the networks of a file that `write_motion_networks` or AMUSE's authors wrote.

    Raises
    ------
    InputError
        If the file is no such network.
    """
    if not holds_facts(path):
        return MotionNetworks(model=read_motion_model(path))
    with _MOTION.reading(path) as file:
        model = MotionModel(MotionConfig(**file.facts["config"]))
        for part, network in model.named_children():
            file.loaded(network, part)
        return MotionNetworks(model=model.eval(), training=file.facts["training"])


def load_speech_network(path: Path) -> SpeechNetwork:
    """Return the network of a file that `write_speech_network` or AMUSE's authors wrote.

    Raises
    ------
    InputError
        If the file is no such network.
    """
    if not holds_facts(path):
        return SpeechNetwork(model=read_speech_model(path))
    with _SPEECH.reading(path) as file:
        return SpeechNetwork(
            model=file.loaded(speech_model_of(SpeechConfig(**file.facts["config"])), "model"),
            latents={
                part: {label: file.tensors[f"{part}.{label}"] for label in labels}
                for part, labels in file.facts["labels"].items()
            },
            training=file.facts["training"],
        )
