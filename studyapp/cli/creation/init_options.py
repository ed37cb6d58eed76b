"""What `motionjury init` reads of options and answers."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Final

from generators.registry import generator_names, needs_source, settings_type
from generators.settings import File, told
from motion.errors import InputError, listed
from motion.segment import check_name
from studyapp.cli.material.generate_command import condition_of
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.recruitment import MONEY, Pay

FILES: Final = "files"
VIDEOS: Final = "videos"

LONGEST: Final = 240
"""Minutes that a study may take."""

RECRUITING_SITES: Final = ("prolific", "mturk")
"""Channels that must be told what participants get and how long it takes."""


def read_condition(text: str, folder: Path) -> tuple[str, Condition]:
    """Return a condition from ``NAME=SOURCE``.

    Parameters
    ----------
    text : str
        The source is ``files``, ``videos``, a generator, ``mismatched:NAME``, or a network and
        the file of its weights, ``NETWORK:FILE``, ``NETWORK:FILE,FILE`` where it has several.
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
    if needed := _needed_files(kind):
        weights = zip(needed, _weights(kind, of, needed), strict=True)
        return condition_of(kind, dict(weights), folder)
    if needs_source(kind) != bool(of):
        says = "needs the condition it starts from" if needs_source(kind) else "needs no source"
        example = f"{kind}:OTHER" if needs_source(kind) else kind
        raise InputError(f"the generator {kind!r} {says}", remedy=f"Give {example}")
    return Condition(generator=kind, source=check_name(of, "condition") if of else None)


def _needed_files(generator: str) -> list[str]:
    """Return the keys of the files that a generator cannot do without."""
    kind = settings_type(generator)
    needed = (each for each in told(kind) if each.type == File)
    return [each.option for each in needed if kind.model_fields[each.keys[0]].is_required()]


def _weights(generator: str, given: str, needed: Sequence[str]) -> list[Path]:
    """Return the files of a network's weights."""
    files = given.split(",") if len(needed) > 1 else [given]
    if not all(files) or len(files) != len(needed):
        raise InputError(
            f"the generator {generator!r} is a network and needs its weights",
            remedy=f"Give {source_words(generator)}, its {listed(needed)}",
        )
    paths = [Path(file.strip()).expanduser() for file in files]
    for path in paths:
        if not path.is_file():
            raise InputError("there is no such file of weights", where=path)
    return paths


def source_words(generator: str) -> str:
    """Return a generator as a source is written."""
    of = "OTHER" if needs_source(generator) else ",".join("FILE" for _ in _needed_files(generator))
    return f"{generator}:{of}" if of else generator


def generator_sources() -> tuple[str, ...]:
    """Return the generators as sources are written."""
    return tuple(map(source_words, generator_names()))


def source_of(condition: Condition, folder: Path) -> str:
    """Return the source of a condition of a study in `folder` as it is written in an option."""
    if condition.generator is None:
        return VIDEOS if condition.videos else FILES
    keys = _needed_files(condition.generator)
    of = ",".join(str(folder / getattr(condition.settings, key)) for key in keys)
    of = of or condition.source or ""
    return f"{condition.generator}:{of}" if of else condition.generator


def read_pay(text: str, channel: str | None) -> Pay | None:
    """Return what each participant gets from ``AMOUNT CURRENCY``, None for nothing.

    Raises
    ------
    InputError
        If it is not an amount with a currency, or nothing though the channel is a recruiting site.
    """
    given = "" if text == "-" else text.strip().replace(",", ".")
    amount, _, currency = given.partition(" ")
    if re.fullmatch(r"\d+(\.\d)?", amount):
        amount = f"{Decimal(amount):.2f}"
    if not re.fullmatch(MONEY, amount):
        raise InputError(f"{amount!r} is not an amount", remedy="Give one such as 2.50 EUR")
    if not amount or not Decimal(amount):
        if channel in RECRUITING_SITES:
            raise InputError("recruiting sites must be told what participants get")
        return None
    currency = currency or ("USD" if channel == "mturk" else "")
    if not re.fullmatch(r"[A-Za-z]{3}", currency):
        raise InputError(
            f"{currency!r} is not a currency" if currency else "an amount needs a currency",
            remedy="Give its three letters after the amount, such as 2.50 EUR",
        )
    return Pay(amount=amount, currency=currency.upper())


def read_count(most: int, *, what: str) -> Callable[[str], int]:
    """Return what reads a whole number of `what` from 1 to `most`."""

    def read(text: str) -> int:
        if not text.isdecimal() or not 1 <= int(text) <= most:
            raise InputError(
                f"{text!r} is not a number of {what}",
                remedy=f"Give a whole number from 1 to {most}",
            )
        return int(text)

    return read
