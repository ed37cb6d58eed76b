"""Which generators there are; none is imported before it is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import Final, cast

from generators.interface import Generator
from motion.errors import InputError
from motion.source_version import source_version


@dataclass(frozen=True)
class _Entry:
    """Where a generator lives, and whether it starts from another condition's clips."""

    home: str
    needs_source: bool = False


_GENERATORS: Final = MappingProxyType(
    {
        "rule_based": _Entry("generators.rule_based.generator:RuleBased"),
        "mismatched": _Entry("generators.mismatched:Mismatched", needs_source=True),
        "static": _Entry("generators.static:Static"),
        "broken": _Entry("generators.broken:Broken", needs_source=True),
    }
)


def generator_names() -> tuple[str, ...]:
    """Return the names of all generators."""
    return tuple(_GENERATORS)


def needs_source(name: str) -> bool:
    """Tell whether generator `name` starts from another condition's clips."""
    return _entry(name).needs_source


def generator_version(name: str) -> str:
    """Return a text that changes whenever generator `name` might move otherwise."""
    home = _entry(name).home.partition(":")[0].split(".")
    own = f"{'/'.join(home[:-1])}/*.py" if len(home) > 2 else f"{'/'.join(home)}.py"
    shared = ("generators/clip_length.py", "motion/prosody.py", "motion/resample.py")
    return source_version((own, *shared))


def load_generator(name: str) -> Generator:
    """Return a generator by its name.

    Raises
    ------
    InputError
        If there is no generator of that name.
    """
    module, _, factory = _entry(name).home.partition(":")
    return cast("Generator", getattr(import_module(module), factory)())


def _entry(name: str) -> _Entry:
    if name not in _GENERATORS:
        raise InputError(
            f"there is no generator {name!r}", remedy=f"Use one of {', '.join(_GENERATORS)}"
        )
    return _GENERATORS[name]
