"""The generators and which of them can be trained; each is imported when it is used."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, cast

from pydantic import TypeAdapter

from generators.interface import Generator
from generators.learned_settings import ModelSettings
from generators.settings import Settings
from motion.errors import InputError

if TYPE_CHECKING:
    from training.data.take import TakeFolder

Show = Callable[[int, int, str], None]
"""Told how much is done, of how much, and what was last."""


def show_nothing(done: int, total: int, detail: str) -> None:
    """Show nothing."""


Device = Literal["cpu", "cuda"]


@dataclass(frozen=True, kw_only=True)
class TrainingChoice:
    """A setting that only this generator has.

    Attributes
    ----------
    name : str
        Its name on the command line, such as ``ablation``.
    help : str
        Its description in the command's help.
    values : tuple of str
        Its values; a path if there are none.
    file : bool
        Whether that is a file's path, and not a folder's.
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
        Facts that a researcher should know before.
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
        """Return its training function; its module is imported now."""
        return cast("TrainGenerator", _import_object(self.home))


@dataclass(frozen=True, kw_only=True)
class TrainingRequest:
    """A researcher's request.

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
        The generator's own choices that were made.
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
    show_preparing: Show = show_nothing
    show_training: Show = show_nothing


def run_folder(out: Path) -> Path:
    """Return the folder of the run that makes the network's file `out`."""
    return out.with_suffix(".run")


@dataclass(frozen=True, kw_only=True)
class TrainedGenerator:
    """The outcome of a training.

    Attributes
    ----------
    sentences : tuple of str
        What was learned, from which data, and how well, in sentences.
    skipped : tuple of InputError
        Recordings that could not be used.
    warnings : tuple of str
        Reasons to doubt the result.
    """

    sentences: tuple[str, ...]
    skipped: tuple[InputError, ...]
    warnings: tuple[str, ...] = ()


TrainGenerator = Callable[[TrainingRequest], TrainedGenerator]
"""Trains a generator's network and writes its file, or goes on where an earlier call stopped.

Raises InputError if the recordings do not fit or the run that is kept is another one, and
`training.run.loop.TrainingStopped` after Ctrl-C; the state is saved then.
"""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A generator's module and settings.

    Attributes
    ----------
    home : str
        What makes the `generators.interface.Generator`, ``module:name``: called with nothing, or
        with its settings and ``'cpu'`` or ``'cuda'`` where it has any.
    needs_source : bool
        Whether it starts from another condition's clips.
    settings : str or None
        Its type of `generators.settings.Settings`, ``module:name``, whose module loads no torch.
        One whose weights must be given has `generators.learned_settings.ModelSettings`.
    summary : str
        What its motion is, for those who make a study; empty if it is for catch trials alone, or
        a network, which is described by its weights.
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
"""Every generator under its name; whoever has another one adds it before a study is read."""

TRAINABLE: Final = TypeAdapter(dict[str, Trainable]).validate_python(
    tomllib.loads(Path(__file__).with_name("trainables.toml").read_text("utf-8"))
)
"""Trainable networks by name."""


def generator_names() -> tuple[str, ...]:
    """Return the names of all generators."""
    return tuple(GENERATORS)


def needs_source(name: str) -> bool:
    """Tell whether generator `name` starts from another condition's clips."""
    return _entry(name).needs_source


def needs_model(name: str) -> bool:
    """Tell whether generator `name` is a network whose weights must be given."""
    return issubclass(settings_type(name), ModelSettings)


def settings_type(name: str) -> type[Settings]:
    """Return the type of what generator `name` takes, `Settings` itself for nothing but speech."""
    home = _entry(name).settings
    return Settings if home is None else cast("type[Settings]", _import_object(home))


def load_generator(name: str, settings: Settings | None = None, device: str = "cpu") -> Generator:
    """Return a generator by its name.

    Parameters
    ----------
    name : str
        One of `generator_names`.
    settings : Settings, optional
        Its settings, with paths relative to the current folder.
    device : {'cpu', 'cuda'}
        Where a network runs.

    Raises
    ------
    InputError
        If there is no generator of that name, or it needs settings and none are given, or the other
        way round.
    """
    kind = settings_type(name)
    if settings is None and needs_model(name):
        raise InputError(
            f"the generator {name} is a network and was given no weights",
            remedy="Name their file as its 'checkpoint' in study.toml",
        )
    settings = kind() if settings is None else settings
    if type(settings) is not kind:
        network = "another network" if needs_model(name) else "no network"
        raise InputError(
            f"the generator {name} is {network} and takes no {type(settings).__name__}",
            remedy="Leave them out, or name another generator",
        )
    make = _import_object(_entry(name).home)
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
