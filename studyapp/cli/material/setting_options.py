"""Options for what generators take besides speech, read off their settings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final, Literal, get_args, get_origin

import click
from pydantic import ValidationError

from generators.registry import generator_names, settings_type
from generators.settings import File, Folder, Told, told
from motion.errors import InputError
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.validation import explain

_TYPES: Final = {
    File: click.Path(dir_okay=False, path_type=Path),
    Folder: click.Path(file_okay=False, path_type=Path),
    int: click.INT,
    float: click.FLOAT,
    bool: click.BOOL,
}


class SettingsCommand(click.Command):
    """A command that has an option for each setting of any generator, but where it has its own."""

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Return the command's own options, those of generators, and --help."""
        *own, last = super().get_params(ctx)
        taken = {param.name for param in own}
        return [*own, *(option for option in _options() if option.name not in taken), last]


def condition_of(
    generator: str | None, given: Mapping[str, Any], folder: Path = Path()
) -> Condition:
    """Return the condition of a study in `folder` that options describe.

    Parameters
    ----------
    generator : str or None
        Who moves.
    given : mapping
        What was said in options of `SettingsCommand`, None where nothing was.
    folder : Path
        Files that lie outside it are named by their full path.

    Raises
    ------
    InputError
        If an option is of another generator, or its value cannot be used.
    """
    values: dict[str, Any] = {"generator": generator}
    said = {name: value for name, value in given.items() if value is not None}
    for each in () if generator is None else told(settings_type(generator)):
        value = said.pop(each.option, None)
        if value is None:
            continue
        table = values
        for key in each.keys[:-1]:
            table = table.setdefault(key, {})
        if isinstance(value, Path):
            value = named_from(folder, value)
        elif isinstance(value, str) and value.isdecimal():
            value = int(value) if int in (each.type, *get_args(each.type)) else value
        table[each.keys[-1]] = value
    for option in said:
        raise InputError(
            f"--{option.replace('_', '-')} is of a learned generator, not of "
            f"{generator or 'motion that is brought in'}",
            remedy=f"Leave it out, or give --generator {' or '.join(_takers(option))}",
        )
    try:
        return Condition.model_validate(values)
    except ValidationError as error:
        raise InputError(explain(error), remedy="Correct these options") from None


def named_from(folder: Path, path: Path) -> str:
    """Return how a study in `folder` names a file: from there, or in full where it lies outside."""
    there, base = path.resolve(), folder.resolve()
    return str(there.relative_to(base) if there.is_relative_to(base) else there)


def _options() -> Iterator[click.Option]:
    """Yield an option for each setting of any generator, those that several have once."""
    found: dict[str, dict[str, Told]] = {}
    for generator in generator_names():
        for each in told(settings_type(generator)):
            found.setdefault(each.option, {})[generator] = each
    for name, takers in found.items():
        types = {each.type for each in takers.values()}
        meanings = {generator: each.description for generator, each in takers.items()}
        same = len(set(meanings.values())) == 1
        yield click.Option(
            [f"--{name.replace('_', '-')}"],
            type=_type(types.pop()) if len(types) == 1 else click.STRING,
            help=" ".join(
                dict.fromkeys(
                    meaning if same else f"Of {generator}: {meaning}"
                    for generator, meaning in meanings.items()
                )
            ),
        )


def _type(kind: Any) -> click.ParamType[Any]:
    if get_origin(kind) is Literal:
        return click.Choice(get_args(kind))
    return _TYPES.get(kind, click.STRING)


def _takers(option: str) -> list[str]:
    return [
        generator
        for generator in generator_names()
        if option in (each.option for each in told(settings_type(generator)))
    ]
