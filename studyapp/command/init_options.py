"""What `motionjury init` reads of options and answers."""

from __future__ import annotations

import re
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Final

from generators.registry import generator_names, needs_model, needs_source
from generators.settings import ModelSettings
from motion.errors import InputError
from motion.segment import check_name
from studyapp.command.setting_options import condition_of
from studyapp.definition.conditions import Condition
from studyapp.definition.pay import MONEY

FILES: Final = "files"
VIDEOS: Final = "videos"

LONGEST: Final = 240
"""Minutes that a study may take."""


def read_condition(text: str, folder: Path) -> tuple[str, Condition]:
    """Return a condition from ``NAME=SOURCE``.

    Parameters
    ----------
    text : str
        The source is ``files``, ``videos``, a generator, ``mismatched:NAME``, or a network and
        the file of its weights, ``NETWORK:FILE``.
    folder : Path
        The study's, from which files are named.

    Raises
    ------
    InputError
        If it is none of these, or there is no such file.
    """
    name, equals, source = text.partition("=")
    if not equals:
        raise InputError(
            f"{text!r} does not say where its motion comes from",
            remedy="Give NAME=files, NAME=videos, NAME=rule_based or NAME=mismatched:OTHER",
        )
    return check_name(name.strip(), "condition"), read_source(source.strip(), folder)


def read_source(text: str, folder: Path) -> Condition:
    """Return a condition from where its motion comes from; see `read_condition`."""
    kind, _, of = text.partition(":")
    if kind in (FILES, VIDEOS) and not of:
        return Condition(videos=kind == VIDEOS)
    if kind not in generator_names():
        raise InputError(
            f"unknown source {text!r}",
            remedy=f"Use {FILES}, {VIDEOS}, or a generator: {', '.join(generator_sources())}",
        )
    if needs_model(kind):
        return condition_of(kind, {"checkpoint": _weights(kind, of)}, folder)
    if needs_source(kind) != bool(of):
        says = "needs the condition it starts from" if needs_source(kind) else "needs no source"
        example = f"{kind}:OTHER" if needs_source(kind) else kind
        raise InputError(f"the generator {kind!r} {says}", remedy=f"Give {example}")
    return Condition(generator=kind, source=check_name(of, "condition") if of else None)


def _weights(generator: str, file: str) -> Path:
    """Return the file of a network's weights."""
    if not file:
        raise InputError(
            f"the generator {generator!r} is a network and needs its weights",
            remedy=f"Give {generator}:FILE, its checkpoint",
        )
    path = Path(file).expanduser()
    if not path.is_file():
        raise InputError("there is no such file of weights", where=path)
    return path


def generator_sources() -> tuple[str, ...]:
    """Return the generators as sources are written."""
    return tuple(
        f"{name}:OTHER" if needs_source(name) else f"{name}:FILE" if needs_model(name) else name
        for name in generator_names()
    )


def source_of(condition: Condition, folder: Path) -> str:
    """Return the source of a condition of a study in `folder` as it is written in an option."""
    if condition.generator is None:
        return VIDEOS if condition.videos else FILES
    told = condition.settings
    of = str(folder / told.checkpoint) if isinstance(told, ModelSettings) else condition.source
    return f"{condition.generator}:{of}" if of else condition.generator


def read_amount(text: str) -> str:
    """Return an amount of money as study files have it; empty for none.

    Raises
    ------
    InputError
        If it is no amount.
    """
    plain = text.replace(",", ".")
    if re.fullmatch(r"\d+(\.\d)?", plain):
        plain = f"{Decimal(plain):.2f}"
    if not re.fullmatch(MONEY, plain):
        raise InputError(f"{text!r} is no amount", remedy="Give one such as 2.50")
    return "" if plain and not Decimal(plain) else plain


def read_currency(text: str) -> str:
    """Return a currency's three letters; `InputError` where they are none."""
    if not re.fullmatch(r"[A-Za-z]{3}", text):
        raise InputError(f"{text!r} is no currency", remedy="Give three letters, such as EUR")
    return text.upper()


def read_count(most: int, *, what: str) -> Callable[[str], int]:
    """Return what reads a whole number of `what` from 1 to `most`."""

    def read(text: str) -> int:
        if not text.isdecimal() or not 1 <= int(text) <= most:
            raise InputError(
                f"{text!r} is no number of {what}",
                remedy=f"Give a whole number from 1 to {most}",
            )
        return int(text)

    return read
