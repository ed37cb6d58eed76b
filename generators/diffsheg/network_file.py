"""A DiffSHEG network with all that its motion depends on, from our files or the authors'."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch

from generators.diffsheg.config import DenoiserConfig
from generators.diffsheg.model import Denoiser
from generators.diffsheg.released import DATASETS, load_released, read_normalisation
from motion.errors import InputError
from training.spaces.normalisation import Normalisation
from training.speakers import Speakers
from training.weights_file import NetworkKind, holds_facts

_NETWORK: Final = NetworkKind(
    name="diffsheg",
    wanted="a DiffSHEG network",
    remedy="Give a DiffSHEG checkpoint: one that was trained here, or the released one",
)


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionNetwork:
    """A network that tells motion.

    Attributes
    ----------
    denoiser : Denoiser
        In evaluation mode, on the CPU.
    dataset : {'beat', 'show'}
        Whose motion its values are.
    normalisation : Normalisation
        Of its values.
    speakers : Speakers or None
        Whom it learned from; None where only their numbers are known, as of a released network.
    hubert : str or None
        Which network heard the speech for it, `Hubert.identity`; None where nobody knows.
    training : mapping
        How it was trained, as JSON values; empty where nobody knows.
    """

    denoiser: Denoiser
    dataset: str
    normalisation: Normalisation
    speakers: Speakers | None = None
    hubert: str | None = None
    training: Mapping[str, Any] = field(default_factory=dict)


def write_network(path: Path, network: MotionNetwork) -> None:
    """Write a network to one safetensors file, with its sizes, its normalisation and its origin."""
    normalisation = network.normalisation
    _NETWORK.write(
        path,
        {"denoiser": network.denoiser},
        network.denoiser.config,
        {
            "normalisation.mean": torch.from_numpy(normalisation.mean),
            "normalisation.std": torch.from_numpy(normalisation.std),
        },
        dataset=network.dataset,
        speakers=None if network.speakers is None else list(network.speakers.names),
        hubert=network.hubert,
        training=dict(network.training),
    )


def load_network(path: Path, dataset: str, stats: Path | None) -> MotionNetwork:
    """Return the network of a file that `write_network` or DiffSHEG's authors wrote.

    Parameters
    ----------
    path : Path
        The checkpoint.
    dataset : {'beat', 'show'}
        What a released checkpoint was trained on.
    stats : Path or None
        Folder of its means and standard deviations; see
        `generators.diffsheg.released.read_normalisation`.

    Raises
    ------
    InputError
        If the file is no such network, or a released one comes without its normalisation.
    """
    if holds_facts(path):
        return _own(path)
    if stats is None:
        raise InputError(
            "a released checkpoint says nothing of means and standard deviations, without which "
            "its values are no motion",
            where=path,
            remedy="Name their folder as 'stats': axis_angle_mean.npy, axis_angle_std.npy, "
            "json_mean.npy, json_std.npy",
        )
    denoiser = load_released(path, dataset)
    return MotionNetwork(
        denoiser=denoiser,
        dataset=dataset,
        normalisation=read_normalisation(stats, denoiser.config),
    )


def _own(path: Path) -> MotionNetwork:
    with _NETWORK.reading(path) as file:
        facts, config = file.facts, DenoiserConfig(**file.facts["config"])
        if facts["dataset"] not in DATASETS:
            raise ValueError("another data set")
        mean, std = (np.asarray(file.tensors[f"normalisation.{kind}"]) for kind in ("mean", "std"))
        if mean.shape != (config.motion_width,) or std.shape != mean.shape:
            raise ValueError("a normalisation of another size")
        names = facts["speakers"]
        return MotionNetwork(
            denoiser=file.loaded(Denoiser(config), "denoiser"),
            dataset=str(facts["dataset"]),
            normalisation=Normalisation(mean, std),
            speakers=None if names is None else Speakers(tuple(names), config.speakers),
            hubert=facts["hubert"],
            training=facts["training"],
        )
