"""How a learned generator says what can be trained of it; nothing here loads a network."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

from motion.errors import InputError

if TYPE_CHECKING:
    from training.data.take import TakeFolder

Show = Callable[[int, int, str], None]
"""Told how much is done, of how much, and what was last."""


def unseen(done: int, total: int, detail: str) -> None:
    """Show nothing."""


Device = Literal["cpu", "cuda"]


@dataclass(frozen=True, kw_only=True)
class TrainingChoice:
    """A setting that only this generator has.

    Attributes
    ----------
    name : str
        As the command line tells it, such as ``ablation``.
    help : str
        What it does, for whoever reads the command's help.
    values : tuple of str
        What it may be; a path where there are none.
    file : bool
        Whether that is a file's path, and not a folder's.
    """

    name: str
    help: str
    values: tuple[str, ...] = ()
    file: bool = False


@dataclass(frozen=True, kw_only=True)
class Trainable:
    """What can be trained of a generator.

    Attributes
    ----------
    summary : str
        One sentence for the list of commands.
    explanation : str
        What a researcher should know before.
    configs : mapping of str to str
        Sizes by name, with what each is for; the first is usual.
    home : str
        Where its `TrainGenerator` lives, ``module:function``.
    choices : tuple of TrainingChoice
        Settings of its own.
    taken_by : str
        The command that takes the network's file, which stands for ``{out}`` in it.
    """

    summary: str
    explanation: str
    configs: Mapping[str, str]
    home: str
    choices: tuple[TrainingChoice, ...] = ()
    taken_by: str

    def load(self) -> TrainGenerator:
        """Return what trains it; its module is imported now."""
        module, _, function = self.home.partition(":")
        return cast("TrainGenerator", getattr(import_module(module), function))


@dataclass(frozen=True, kw_only=True)
class TrainingRequest:
    """What a researcher asks for.

    Attributes
    ----------
    takes : TakeFolder
        The recordings.
    out : Path
        File of the network, which the generator takes as its checkpoint.
    cache : Path
        Folder that keeps what is computed of the recordings.
    config : str
        One of `Trainable.configs`.
    changes : mapping
        Fields of `training.config.TrainingConfig` that are to differ from the config's.
    choices : mapping of str to str
        Of the generator's own choices, those that were made.
    device : {'cpu', 'cuda'}
        Where it is computed.
    show_preparing, show_training : callable
        Told about progress.
    """

    takes: TakeFolder
    out: Path
    cache: Path
    config: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    choices: Mapping[str, str] = field(default_factory=dict)
    device: Device = "cpu"
    show_preparing: Show = unseen
    show_training: Show = unseen

    @property
    def run(self) -> Path:
        """Folder of the run."""
        return run_of(self.out)


def run_of(out: Path) -> Path:
    """Return the folder of the run that makes the network's file `out`."""
    return out.with_suffix(".run")


@dataclass(frozen=True, kw_only=True)
class TrainedGenerator:
    """What came out.

    Attributes
    ----------
    sentences : tuple of str
        What was learned, from what, and how well, for whoever asked.
    skipped : tuple of InputError
        Recordings that could not be used.
    warnings : tuple of str
        What should make them doubt it.
    """

    sentences: tuple[str, ...]
    skipped: tuple[InputError, ...]
    warnings: tuple[str, ...] = ()


TrainGenerator = Callable[[TrainingRequest], TrainedGenerator]
"""Trains a generator's network and writes its file, or goes on where an earlier call stopped.

Raises InputError if the recordings do not fit or the run that is kept is another one, and
`training.run.loop.TrainingStopped` after Ctrl-C; the state is saved then.
"""
