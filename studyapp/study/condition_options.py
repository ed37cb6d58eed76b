"""Conditions of a new study, read from options and answers."""

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


def read_conditions(texts: Sequence[str], folder: Path) -> dict[str, Condition] | None:
    """Return the conditions that ``NAME=SOURCE`` each describe; None for no text.

    Parameters
    ----------
    texts : sequence of str
        A source is ``files``, ``videos``, a generator, ``mismatched:NAME``, or a network and its
        weights: ``NETWORK:FILE``, or ``NETWORK:FILE,FILE`` if it has several files.
    folder : Path
        The study folder.

    Raises
    ------
    InputError
        If a source is none of these, a file is missing, or two conditions have the same name.
    """
    conditions: dict[str, Condition] = {}
    for text in texts:
        name, equals, source = text.partition("=")
        if not equals:
            raise InputError(
                f"{text!r} does not say where its motion comes from",
                remedy="Give NAME=files, NAME=videos, NAME=rule_based or NAME=mismatched:OTHER",
            )
        name = check_name(name.strip(), "condition")
        if name in conditions:
            raise InputError(f"the condition {name!r} is given twice", remedy="Name each once")
        conditions[name] = _read_source(source.strip(), folder)
    return conditions or None


def _read_source(text: str, folder: Path) -> Condition:
    kind, _, details = text.partition(":")
    if kind in (FILES, VIDEOS) and not details:
        return Condition(videos=kind == VIDEOS)
    if kind not in generator_names():
        raise InputError(
            f"unknown source {text!r}",
            remedy=f"Use {FILES}, {VIDEOS}, or a generator: "
            f"{', '.join(map(source_notation, generator_names()))}",
        )
    if required := _required_files(kind):
        weights = zip(required, _read_weight_files(kind, details, required), strict=True)
        return make_condition(kind, dict(weights), folder)
    if needs_source(kind) != bool(details):
        need = "needs the condition it starts from" if needs_source(kind) else "takes no source"
        raise InputError(f"the generator {kind!r} {need}", remedy=f"Give {source_notation(kind)}")
    return Condition(generator=kind, source=check_name(details, "condition") if details else None)


def _required_files(generator: str) -> list[str]:
    """Return the keys of the files that a generator needs."""
    settings = settings_of(settings_type(generator))
    return [setting.key for setting in settings if setting.type == File and setting.required]


def _read_weight_files(generator: str, text: str, required: Sequence[str]) -> list[Path]:
    """Return the files of a network's weights."""
    files = text.split(",") if len(required) > 1 else [text]
    if not all(files) or len(files) != len(required):
        raise InputError(
            f"the generator {generator!r} is a network and needs its weights",
            remedy=f"Give {source_notation(generator)}, its {listed(required)}",
        )
    paths = [Path(file.strip()).expanduser() for file in files]
    for path in paths:
        if not path.is_file():
            raise InputError("this file of weights does not exist", where=path)
    return paths


def source_notation(generator: str) -> str:
    """Return how a generator is given as a source."""
    details = (
        "OTHER" if needs_source(generator) else ",".join("FILE" for _ in _required_files(generator))
    )
    return f"{generator}:{details}" if details else generator


def make_condition(
    generator: str | None, options: Mapping[str, Any], folder: Path = Path()
) -> Condition:
    """Return the condition that options describe.

    Parameters
    ----------
    generator : str or None
        None for imported motion.
    options : mapping
        Options of `SettingsCommand`; None where one is not given.
    folder : Path
        The study folder; files elsewhere are named by their full path.

    Raises
    ------
    InputError
        If an option belongs to another generator, or its value is unusable.
    """
    values: dict[str, Any] = {"generator": generator}
    unused = {name: value for name, value in options.items() if value is not None}
    for setting in () if generator is None else settings_of(settings_type(generator)):
        value = unused.pop(setting.key, None)
        if value is None:
            continue
        if isinstance(value, Path):
            value = _path_from(folder, value)
        elif isinstance(value, str) and value.isdecimal():
            value = int(value) if int in (setting.type, *get_args(setting.type)) else value
        values[setting.key] = value
    for option in unused:
        takers = [name for name in generator_names() if option in settings_type(name).model_fields]
        raise InputError(
            f"--{option.replace('_', '-')} belongs to a learned generator, not to "
            f"{generator or 'imported motion'}",
            remedy=f"Leave it out, or give --generator {' or '.join(takers)}",
        )
    try:
        return Condition.model_validate(values)
    except ValidationError as error:
        raise InputError(explain_errors(error), remedy="Correct these options") from None


def _path_from(folder: Path, path: Path) -> str:
    """Return `path` relative to `folder`, or in full if it lies elsewhere."""
    file, base = path.resolve(), folder.resolve()
    return str(file.relative_to(base) if file.is_relative_to(base) else file)
