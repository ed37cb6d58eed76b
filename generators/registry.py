"""Which generators there are; none is imported before it is asked for."""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import Final, cast

from generators.interface import Generator
from motion.errors import InputError

_HOMES: Final = MappingProxyType(
    {
        "rule_based": "generators.rule_based.generator:RuleBased",
        "mismatched": "generators.mismatched:Mismatched",
        "static": "generators.static:Static",
        "broken": "generators.broken:Broken",
    }
)


def generator_names() -> tuple[str, ...]:
    """Return the names of all generators."""
    return tuple(_HOMES)


def load_generator(name: str) -> Generator:
    """Return a generator by its name.

    Raises
    ------
    InputError
        If there is no generator of that name.
    """
    if name not in _HOMES:
        raise InputError(
            f"there is no generator {name!r}", remedy=f"Use one of {', '.join(_HOMES)}"
        )
    module, _, factory = _HOMES[name].partition(":")
    return cast("Generator", getattr(import_module(module), factory)())
