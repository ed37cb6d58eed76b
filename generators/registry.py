"""Which generators there are; none is imported before it is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, Final, cast

from generators.interface import Generator
from generators.settings import ModelSettings, Settings
from generators.trainable import Trainable
from motion.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Entry:
    """Where a generator lives, what it takes, and how it is trained.

    Attributes
    ----------
    home : str
        What makes the `generators.interface.Generator`, ``module:name``: called with nothing, or
        with its settings and ``'cpu'`` or ``'cuda'`` where it has any.
    needs_source : bool
        Whether it starts from another condition's clips.
    settings : str or None
        Its type of `generators.settings.Settings`, ``module:name``, whose module loads no torch.
        One whose weights must be given has `generators.settings.ModelSettings`.
    trainable : mapping of str to str
        Its networks that learn, by the name that trains them: `generators.trainable.Trainable`,
        ``module:name``.
    """

    home: str
    needs_source: bool = False
    settings: str | None = None
    trainable: Mapping[str, str] = field(default_factory=dict)


GENERATORS: Final = {
    "rule_based": Entry(home="generators.rule_based.generator:RuleBased"),
    "mismatched": Entry(home="generators.mismatched:Mismatched", needs_source=True),
    "static": Entry(home="generators.static:Static"),
    "broken": Entry(home="generators.broken:Broken", needs_source=True),
    "diffsheg": Entry(
        home="generators.diffsheg.generate:DiffSheg",
        settings="generators.diffsheg.settings:DiffShegSettings",
        trainable={"diffsheg": "generators.diffsheg.config:TRAINABLE"},
    ),
    "amuse": Entry(
        home="generators.amuse.generate:Amuse",
        settings="generators.amuse.settings:AmuseSettings",
        trainable={
            "amuse": "generators.amuse.config:TRAINABLE",
            "amuse-speech": "generators.amuse.config:TRAINABLE_SPEECH",
        },
    ),
    "s2ue": Entry(
        home="generators.s2ue.generate:S2ue",
        settings="generators.s2ue.settings:S2ueSettings",
        trainable={"s2ue": "generators.s2ue.config:TRAINABLE"},
    ),
}
"""Every generator under its name; whoever has another one adds it before a study is read."""


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
    return Settings if home is None else cast("type[Settings]", _named(home))


def trainable_names() -> tuple[str, ...]:
    """Return the names of the networks that can be trained here."""
    return tuple(name for entry in GENERATORS.values() for name in entry.trainable)


def trainable_of(name: str) -> Trainable:
    """Return what can be trained under that name; no network is loaded.

    Raises
    ------
    InputError
        If nothing learns under that name.
    """
    for entry in GENERATORS.values():
        if name in entry.trainable:
            return cast("Trainable", _named(entry.trainable[name]))
    raise InputError(
        f"the generator {name} does not learn" if name in GENERATORS else f"there is no {name!r}",
        remedy=f"Train one of {', '.join(trainable_names())}",
    )


def load_generator(name: str, settings: Settings | None = None, device: str = "cpu") -> Generator:
    """Return a generator by its name.

    Parameters
    ----------
    name : str
        One of `generator_names`.
    settings : Settings, optional
        What it takes, with paths from here.
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
    make = _named(_entry(name).home)
    return cast("Generator", make() if kind is Settings else make(settings, device))


def _named(home: str) -> Any:
    module, _, name = home.partition(":")
    return getattr(import_module(module), name)


def _entry(name: str) -> Entry:
    if name not in GENERATORS:
        raise InputError(
            f"there is no generator {name!r}", remedy=f"Use one of {', '.join(GENERATORS)}"
        )
    return GENERATORS[name]
