"""Which generators there are; none is imported before it is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import Final, cast

from generators.interface import Generator
from generators.model_settings import ModelSettings
from generators.trainable import Trainable
from motion.errors import InputError


@dataclass(frozen=True)
class _Entry:
    """Where a generator lives, what it cannot do without, and how it is trained."""

    home: str
    needs_source: bool = False
    needs_model: bool = False
    trainable: str | None = None


_GENERATORS: Final = MappingProxyType(
    {
        "rule_based": _Entry("generators.rule_based.generator:RuleBased"),
        "mismatched": _Entry("generators.mismatched:Mismatched", needs_source=True),
        "static": _Entry("generators.static:Static"),
        "broken": _Entry("generators.broken:Broken", needs_source=True),
        "diffsheg": _Entry(
            "generators.diffsheg.generate:DiffSheg",
            needs_model=True,
            trainable="generators.diffsheg.config:TRAINABLE",
        ),
    }
)


def generator_names() -> tuple[str, ...]:
    """Return the names of all generators."""
    return tuple(_GENERATORS)


def needs_source(name: str) -> bool:
    """Tell whether generator `name` starts from another condition's clips."""
    return _entry(name).needs_source


def needs_model(name: str) -> bool:
    """Tell whether generator `name` is a network whose weights must be given."""
    return _entry(name).needs_model


def trainable_names() -> tuple[str, ...]:
    """Return the names of the generators that can be trained here."""
    return tuple(name for name, entry in _GENERATORS.items() if entry.trainable is not None)


def trainable_of(name: str) -> Trainable:
    """Return what can be trained of generator `name`; no network is loaded.

    Raises
    ------
    InputError
        If there is no such generator, or it does not learn.
    """
    home = _entry(name).trainable
    if home is None:
        raise InputError(
            f"the generator {name} does not learn",
            remedy=f"Train one of {', '.join(trainable_names())}",
        )
    module, _, constant = home.partition(":")
    return cast("Trainable", getattr(import_module(module), constant))


def load_generator(name: str, model: ModelSettings | None = None) -> Generator:
    """Return a generator by its name.

    Parameters
    ----------
    name : str
        One of `generator_names`.
    model : ModelSettings, optional
        The weights of a learned generator.

    Raises
    ------
    InputError
        If there is no generator of that name, or it needs weights and none are given, or the other
        way round.
    """
    entry = _entry(name)
    module, _, factory = entry.home.partition(":")
    if entry.needs_model and model is None:
        raise InputError(
            f"the generator {name} is a network and was given no weights",
            remedy="Name their file as its 'checkpoint' in study.toml",
        )
    if not entry.needs_model and model is not None:
        raise InputError(
            f"the generator {name} is no network and takes no checkpoint",
            remedy="Leave the checkpoint out, or name another generator",
        )
    made = getattr(import_module(module), factory)
    return cast("Generator", made() if model is None else made(model))


def _entry(name: str) -> _Entry:
    if name not in _GENERATORS:
        raise InputError(
            f"there is no generator {name!r}", remedy=f"Use one of {', '.join(_GENERATORS)}"
        )
    return _GENERATORS[name]
