"""The generators, and the networks that can be trained; each is imported when it is used."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, cast

from generators.interface import Generator
from generators.learned_settings import ModelSettings
from generators.settings import Settings
from motion.errors import InputError
from training.config import read_presets

if TYPE_CHECKING:
    from training.data.take import TakeFolder

Show = Callable[[int, int, str], None]
"""Called with the amount done, the total, and a detail of the last step."""


def show_nothing(done: int, total: int, detail: str) -> None:
    """Do nothing."""


Device = Literal["cpu", "cuda"]


@dataclass(frozen=True, kw_only=True)
class TrainingChoice:
    """A training setting of one generator only.

    Attributes
    ----------
    name : str
        Its name on the command line, such as ``ablation``.
    help : str
        Its description in the command's help.
    values : tuple of str
        Its possible values; empty for a path.
    file : bool
        Whether the path is a file's, not a folder's.
    """

    name: str
    help: str
    values: tuple[str, ...] = ()
    file: bool = False


@dataclass(frozen=True, kw_only=True)
class Trainable:
    """A trainable network of a generator.

    Attributes
    ----------
    summary : str
        One sentence for the list of commands.
    explanation : str
        Facts that a researcher should know before training it.
    configs : mapping of str to str
        Names of the available sizes, with the purpose of each; the first is the default.
    home : str
        Its `TrainGenerator`, as ``module:function``.
    choices : tuple of TrainingChoice
        Settings that only this network has.
    taken_by : str
        The command that takes the network's file, with ``{out}`` in place of the file.
    """

    summary: str
    explanation: str
    configs: Mapping[str, str]
    home: str
    choices: tuple[TrainingChoice, ...] = ()
    taken_by: str

    def load(self) -> TrainGenerator:
        """Import its module and return its training function."""
        return cast("TrainGenerator", _import_object(self.home))


@dataclass(frozen=True, kw_only=True)
class TrainingRequest:
    """A researcher's request for a training.

    Attributes
    ----------
    takes : TakeFolder
        The recordings.
    out : Path
        File of the network, which the generator takes as its checkpoint.
    cache : Path
        Folder for the recordings' features.
    config : str
        One of `Trainable.configs`.
    changes : mapping
        Changed fields of `training.config.TrainingConfig`.
    choices : mapping of str to str
        Values of `Trainable.choices`, by name.
    device : {'cpu', 'cuda'}
        Device of the training.
    show_preparing, show_training : callable
        Called with the progress.
    """

    takes: TakeFolder
    out: Path
    cache: Path
    config: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    choices: Mapping[str, str] = field(default_factory=dict)
    device: Device = "cpu"
    show_preparing: Show = show_nothing
    show_training: Show = show_nothing


@dataclass(frozen=True, kw_only=True)
class TrainedGenerator:
    """The result of a training.

    Attributes
    ----------
    sentences : tuple of str
        Sentences on what was learned, from which data, and how well.
    skipped : tuple of InputError
        Recordings that could not be used.
    warnings : tuple of str
        Reasons to doubt the result.
    """

    sentences: tuple[str, ...]
    skipped: tuple[InputError, ...]
    warnings: tuple[str, ...] = ()


TrainGenerator = Callable[[TrainingRequest], TrainedGenerator]
"""Trains a generator's network and writes its file, or resumes where an earlier call stopped.

Raises InputError if the recordings do not fit or the run folder has another run, and
`training.run.loop.TrainingStopped` after Ctrl-C, with the state saved.
"""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A generator's module and settings.

    Attributes
    ----------
    home : str
        The class of the `generators.interface.Generator`, as ``module:name``. It is called without
        arguments, or with its settings and ``'cpu'`` or ``'cuda'`` if it has settings.
    needs_source : bool
        Whether it starts from another condition's clips.
    settings : str or None
        Its subclass of `generators.settings.Settings`, as ``module:name``; the module must not load
        torch. Networks have a subclass of `generators.learned_settings.ModelSettings`.
    summary : str
        Description of its motion for researchers who make a study; empty for catch trials only and
        for networks, which are described by their weights.
    """

    home: str
    needs_source: bool = False
    settings: str | None = None
    summary: str = ""


GENERATORS: Final = {
    "rule_based": Entry(
        home="generators.rule_based.generator:RuleBased",
        summary="generated here from the speech: beat gestures by rule",
    ),
    "mismatched": Entry(
        home="generators.controls:Mismatched",
        needs_source=True,
        summary="another condition's motion for other speech: plausible, but out of time",
    ),
    "static": Entry(home="generators.controls:Static", summary="generated here: stands still"),
    "broken": Entry(home="generators.controls:Broken", needs_source=True),
    "diffsheg": Entry(
        home="generators.diffsheg.generate:DiffSheg",
        settings="generators.learned_settings:DiffShegSettings",
    ),
    "amuse": Entry(
        home="generators.amuse.generate:Amuse",
        settings="generators.learned_settings:AmuseSettings",
    ),
    "s2ue": Entry(
        home="generators.s2ue.generate:S2ue",
        settings="generators.learned_settings:S2ueSettings",
    ),
}
"""All generators by name; further ones must be added before a study is read."""

TRAINABLE: Final = read_presets(Path(__file__).with_name("trainables.toml"), Trainable)
"""Trainable networks by name."""


def generator_names() -> tuple[str, ...]:
    """Return the names of all generators."""
    return tuple(GENERATORS)


def needs_source(name: str) -> bool:
    """Return whether generator `name` starts from another condition's clips."""
    return _entry(name).needs_source


def needs_model(name: str) -> bool:
    """Return whether generator `name` is a network whose weights must be given."""
    return issubclass(settings_type(name), ModelSettings)


def settings_type(name: str) -> type[Settings]:
    """Return the type of the settings of generator `name`; `Settings` itself if it has none."""
    home = _entry(name).settings
    return Settings if home is None else cast("type[Settings]", _import_object(home))


def load_generator(name: str, settings: Settings | None = None, device: str = "cpu") -> Generator:
    """Return a generator by its name.

    Parameters
    ----------
    name : str
        One of `generator_names`.
    settings : Settings, optional
        Its settings, an instance of `settings_type`, with paths relative to the current folder.
    device : {'cpu', 'cuda'}
        Device of a network.

    Raises
    ------
    InputError
        If there is no generator of that name.
    """
    kind, make = settings_type(name), _import_object(_entry(name).home)
    return cast("Generator", make() if kind is Settings else make(settings, device))


def _import_object(home: str) -> Any:
    module, _, name = home.partition(":")
    return getattr(import_module(module), name)


def _entry(name: str) -> Entry:
    if name not in GENERATORS:
        raise InputError(
            f"there is no generator {name!r}", remedy=f"Use one of {', '.join(GENERATORS)}"
        )
    return GENERATORS[name]
