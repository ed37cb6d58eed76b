"""Conditions of a new study, as options and answers state them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, get_args

from pydantic import ValidationError

from generators.registry import generator_names, needs_source, settings_type
from generators.settings import File, settings_of
from motion.errors import InputError, listed
from motion.segment import check_name
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.sections import explain_errors

FILES: Final = "files"
VIDEOS: Final = "videos"


def read_conditions(given: Sequence[str], folder: Path) -> dict[str, Condition] | None:
    """Return conditions from ``NAME=SOURCE`` each, None where there are none.

    Raises
    ------
    InputError
        As `read_condition`, and where two have the same name.
    """
    named = [read_condition(text, folder) for text in given]
    names = [name for name, _ in named]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"the condition {twice!r} is given twice", remedy="Name each once")
    return dict(named) or None


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
    kind, _, details = text.partition(":")
    if kind in (FILES, VIDEOS) and not details:
        return Condition(videos=kind == VIDEOS)
    if kind not in generator_names():
        raise InputError(
            f"unknown source {text!r}",
            remedy=f"Use {FILES}, {VIDEOS}, or a generator: {', '.join(generator_notations())}",
        )
    if needed := _required_files(kind):
        weights = zip(needed, _read_weight_files(kind, details, needed), strict=True)
        return make_condition(kind, dict(weights), folder)
    if needs_source(kind) != bool(details):
        says = "needs the condition it starts from" if needs_source(kind) else "needs no source"
        example = f"{kind}:OTHER" if needs_source(kind) else kind
        raise InputError(f"the generator {kind!r} {says}", remedy=f"Give {example}")
    return Condition(generator=kind, source=check_name(details, "condition") if details else None)


def _required_files(generator: str) -> list[str]:
    """Return the keys of the files that a generator cannot do without."""
    settings = settings_of(settings_type(generator))
    return [setting.key for setting in settings if setting.type == File and setting.required]


def _read_weight_files(generator: str, given: str, needed: Sequence[str]) -> list[Path]:
    """Return the files of a network's weights."""
    files = given.split(",") if len(needed) > 1 else [given]
    if not all(files) or len(files) != len(needed):
        raise InputError(
            f"the generator {generator!r} is a network and needs its weights",
            remedy=f"Give {source_notation(generator)}, its {listed(needed)}",
        )
    paths = [Path(file.strip()).expanduser() for file in files]
    for path in paths:
        if not path.is_file():
            raise InputError("there is no such file of weights", where=path)
    return paths


def source_notation(generator: str) -> str:
    """Return a generator as a source is written."""
    details = (
        "OTHER" if needs_source(generator) else ",".join("FILE" for _ in _required_files(generator))
    )
    return f"{generator}:{details}" if details else generator


def generator_notations() -> tuple[str, ...]:
    """Return the generators as sources are written."""
    return tuple(map(source_notation, generator_names()))


def make_condition(
    generator: str | None, given: Mapping[str, Any], folder: Path = Path()
) -> Condition:
    """Return the condition of a study in `folder` that options describe.

    Parameters
    ----------
    generator : str or None
        Who moves.
    given : mapping
        What was stated in options of `SettingsCommand`, None where nothing was.
    folder : Path
        Files that lie outside it are named by their full path.

    Raises
    ------
    InputError
        If an option is of another generator, or its value cannot be used.
    """
    values: dict[str, Any] = {"generator": generator}
    stated = {name: value for name, value in given.items() if value is not None}
    for setting in () if generator is None else settings_of(settings_type(generator)):
        value = stated.pop(setting.key, None)
        if value is None:
            continue
        if isinstance(value, Path):
            value = _path_from(folder, value)
        elif isinstance(value, str) and value.isdecimal():
            value = int(value) if int in (setting.type, *get_args(setting.type)) else value
        values[setting.key] = value
    for option in stated:
        raise InputError(
            f"--{option.replace('_', '-')} is of a learned generator, not of "
            f"{generator or 'motion that is brought in'}",
            remedy=f"Leave it out, or give --generator {' or '.join(_generators_with(option))}",
        )
    try:
        return Condition.model_validate(values)
    except ValidationError as error:
        raise InputError(explain_errors(error), remedy="Correct these options") from None


def _path_from(folder: Path, path: Path) -> str:
    """Return how a study in `folder` names a file: from there, or in full where it lies outside."""
    there, base = path.resolve(), folder.resolve()
    return str(there.relative_to(base) if there.is_relative_to(base) else there)


def _generators_with(option: str) -> list[str]:
    return [
        generator
        for generator in generator_names()
        if option in settings_type(generator).model_fields
    ]
