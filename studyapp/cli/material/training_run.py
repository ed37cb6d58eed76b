"""Training a network into a file, whatever network it is."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from generators.trainable import run_of
from motion.errors import InputError
from training.run.launching import is_leader


@contextmanager
def run_into(out: Path) -> Iterator[None]:
    """Train the network of the file `out` during the block; an interruption says what was saved.

    Raises
    ------
    InputError
        If the file is there, and not the run that made it.
    """
    # Imported here: torch takes seconds to load, which --help need not wait for.
    from training.run.loop import TrainingStopped

    run = run_of(out)
    if out.exists() and not (run / "checkpoint.safetensors").exists():
        raise InputError(
            "there is a file already, and not the run that would go on to make it",
            where=out,
            remedy="Name another --out, or move the file away",
        )
    try:
        yield
    except TrainingStopped as stopped:
        if is_leader():
            steps = f"step {stopped.step} of {stopped.steps}"
            click.echo(f"\nStopped after {steps}; saved in {run}", err=True)
        raise
