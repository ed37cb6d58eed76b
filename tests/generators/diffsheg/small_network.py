"""A small DiffSHEG network."""

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import torch

from generators.diffsheg.config import PRESETS, DenoiserConfig
from generators.diffsheg.model import Denoiser
from generators.diffsheg.network_file import MotionNetwork, Normalisation, write_network


def smaller(config: DenoiserConfig) -> DenoiserConfig:
    return replace(config, width=16, feed_forward=16, heads=2, layers=1, speech_width=8)


TINY: Final = replace(
    PRESETS["tiny"]["beat"].network,
    gesture_width=6,
    expression_width=4,
    speakers=3,
    width=16,
    feed_forward=24,
    heads=2,
)


def small(dataset: str) -> DenoiserConfig:
    return smaller(PRESETS[dataset][dataset].network)


def shaken(config: DenoiserConfig, by: float = 0.1, seed: int = 4) -> Denoiser:
    """Return a network whose weights are all random, also those that start at zero or one."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        denoiser = Denoiser(config).eval()
        with torch.no_grad():
            for weight in denoiser.parameters():
                weight.add_(by * torch.randn_like(weight))
    return denoiser


def small_network(dataset: str = "beat", speakers_differ: float = 1.0) -> MotionNetwork:
    """Return a network of random weights; even its last layers, which start at zero, have some."""
    config = small(dataset)
    denoiser = shaken(config, 0.05 * speakers_differ, seed=9).requires_grad_(False)
    width = config.motion_width
    return MotionNetwork(
        model=denoiser,
        dataset=dataset,
        normalisation=Normalisation(np.zeros(width), np.full(width, 0.01)),
    )


def written_network(path: Path, dataset: str = "beat") -> Path:
    write_network(path, small_network(dataset))
    return path
