"""The networks that are compared: feature networks, DiffSHEG trained and DiffSHEG untrained."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final

import torch

from analysis.metrics.networks.clip_views import Channels
from analysis.metrics.networks.evaluator_request import TRAINING, EvaluatorRequest
from analysis.metrics.networks.training import train_evaluator
from analysis.metrics.networks.training_clips import ClipSource
from generators.diffsheg.model import Denoiser
from generators.diffsheg.network_file import load_network, write_network
from generators.registry import trainable_of
from generators.trainable import Show, TrainingRequest
from motion.formats import read_clip
from training.data.take import Take, TakeFolder
from training.run_folder import RunFolder

LOOKED_AT: Final[tuple[Channels, ...]] = ("gesture", "expression")
"""What feature networks look at: for FGD and for FED."""


def train_network(
    takes: TakeFolder, out: Path, cache: Path, *, seed: int, steps: int | None, show: Show
) -> None:
    """Train DiffSHEG's tiny config on `takes` unless `out` is there already."""
    if out.exists():
        return
    changes: dict[str, object] = {"seed": seed}
    if steps is not None:
        changes["steps"] = steps
    request = TrainingRequest(
        takes=takes,
        out=out,
        cache=cache,
        config="tiny",
        changes=changes,
        show_preparing=show,
        show_training=show,
    )
    trainable_of("diffsheg").load()(request)


def write_untrained(trained: Path, out: Path, *, seed: int) -> None:
    """Write the network of `trained` with weights as they are before any training."""
    network = load_network(trained, "beat", None)
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        fresh = Denoiser(network.denoiser.config)
    write_network(out, replace(network, denoiser=fresh.eval(), training={"steps": 0}))


def train_evaluators(
    takes: Sequence[Take], clips: Mapping[str, Path], folder: Path, *, steps: int | None
) -> list[Path]:
    """Train the feature networks on recorded clips unless their files are there already."""
    sources = [
        ClipSource(
            name=take.name,
            recording=take.name,
            emotion=take.emotion,
            sha256=hashlib.sha256(clips[take.name].read_bytes()).hexdigest(),
            read=partial(read_clip, clips[take.name]),
        )
        for take in takes
    ]
    made = []
    for channels in LOOKED_AT:
        out = folder / f"{channels}.safetensors"
        made.append(out)
        if out.exists():
            continue
        usual = TRAINING["motion", "tiny"]
        request = EvaluatorRequest(
            kind="motion",
            size="tiny",
            channels=channels,
            training=usual if steps is None else replace(usual, steps=steps),
        )
        train_evaluator(request, sources, out, RunFolder(out.with_suffix(".run")))
    return made
