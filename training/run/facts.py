"""What a network's file says of the run that it comes from."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import metadata
from typing import Any, Final

from training.config import TrainingConfig
from training.run.loop import Trained

_PACKAGES: Final = ("motionjury", "numpy", "safetensors", "scipy", "torch")


def package_versions(*further: str) -> dict[str, str]:
    """Return the versions of what every training uses, and of `further` packages."""
    return {name: metadata.version(name) for name in (*_PACKAGES, *further)}


def run_facts(
    config: TrainingConfig,
    trained: Trained[Any],
    kind: str,
    data_sha256: str,
    packages: Sequence[str] = (),
) -> dict[str, Any]:
    """Return how and from what a network was trained, as JSON values.

    Parameters
    ----------
    config : TrainingConfig
        How.
    trained : Trained
        What came out.
    kind : str
        The recordings' layout.
    data_sha256 : str
        Hash of the recordings.
    packages : sequence of str
        What further was used, whose versions are told.
    """
    return {
        "config": config.facts(),
        "best_step": trained.best.step,
        "held_out": dict(trained.best.measured),
        "data": {"kind": kind, "sha256": data_sha256},
        "versions": package_versions(*packages),
    }
