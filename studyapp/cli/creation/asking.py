"""Asking one thing in a terminal, and asking for the conditions of a new study."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final, TypeVar

import click

from generators.registry import generator_names, needs_source
from motion.errors import InputError
from motion.segment import check_name
from studyapp.study.interview import (
    QUESTIONS,
    STAND_INS,
    WITH_REFERENCE,
    Asked,
    reference_asked,
    sources,
)
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.study import GROUND_TRUTH
from studyapp.study.stated_conditions import FILES, generator_sources, read_source, source_of
from studyapp.study.wanted_study import MOST_TOGETHER, WantedStudy

T = TypeVar("T")

WIDTH: Final = 88


def explain(text: str) -> None:
    """Print a paragraph."""
    click.echo()
    click.echo(textwrap.fill(text, WIDTH))


def ask(question: Asked, more: str = "", *, default: str = "", read: Callable[[str], T]) -> T:
    """Ask until `read` accepts the answer, and return what it makes of it.

    Parameters
    ----------
    question : Asked
        What it is for is printed once, before it, where there is something to be said.
    more : str
        What else is to be said before it.
    default : str
        What an empty answer means.
    read : callable
        Raises `InputError` with what is wrong; it is printed, and asked again.
    """
    if question.why:
        explain(question.why + more)

    def checked(text: str) -> T:
        try:
            return read(text.strip())
        except InputError as wrong:
            raise click.UsageError(str(wrong)) from wrong

    answer: T = click.prompt(
        question.label, default=default, value_proc=checked, show_default=bool(default)
    )
    return answer


def choose(question: Asked, offered: Mapping[str, str], *, default: str) -> str:
    """Offer a numbered list, and return the name of what is chosen by number or by name."""
    names = list(offered)
    width = max(map(len, names))

    def chosen(text: str) -> str:
        if text.isdecimal() and 1 <= int(text) <= len(names):
            return names[int(text) - 1]
        if text in names:
            return text
        raise InputError(
            f"{text!r} is none of them", remedy=f"Type a number from 1 to {len(names)}, or a name"
        )

    explain(question.why)
    for number, (name, words) in enumerate(offered.items(), start=1):
        lines = textwrap.wrap(words, WIDTH - width - 7)
        click.echo(f"  {number}  {name:{width}}  {lines[0]}")
        for line in lines[1:]:
            click.echo(f"{'':{width + 7}}{line}")
    return ask(Asked(question.label, ""), default=default, read=chosen)


def agree(question: Asked, *, default: bool) -> bool:
    """Ask for a yes or a no."""
    explain(question.why)
    return click.confirm(question.label, default=default)


THE_TEMPLATES: Final = "stand-ins"


def ask_conditions(template: str, before: WantedStudy, folder: Path) -> WantedStudy:
    """Ask what is compared, with what, and what catch trials can show.

    Parameters
    ----------
    template : str
        The template that was chosen.
    before : WantedStudy
        First answers.
    folder : Path
        The study's, from which files are named.
    """
    where = choose(
        QUESTIONS["conditions"],
        {"own": "name them one after the other", THE_TEMPLATES: STAND_INS},
        default="own" if before.conditions else THE_TEMPLATES,
    )
    if where == THE_TEMPLATES:
        return replace(before, conditions=None, reference=None, catch_videos=False)
    conditions = _named(before.conditions or {}, folder)
    reference = None
    if template in WITH_REFERENCE:
        reference = _reference(template, conditions, before.reference)
    catch_videos = bool(conditions) and all(made.videos for made in conditions.values())
    if catch_videos:
        catch_videos = agree(QUESTIONS["catch_videos"], default=before.catch_videos)
    return replace(before, conditions=conditions, reference=reference, catch_videos=catch_videos)


def _named(before: Mapping[str, Condition], folder: Path) -> dict[str, Condition]:
    """Ask for names and sources of conditions until there is no more."""
    explain(
        f"Name the conditions as files and tables will: 'ours', 'baseline', and the real recording "
        f"'{GROUND_TRUTH}'. For each, say where its motion comes from: a number, or a name such as "
        f"{', '.join(generator_sources())}."
    )
    for number, (source, words) in enumerate(sources().items(), start=1):
        click.echo(f"  {number}  {source:10}  {words}")
    conditions: dict[str, Condition] = {}
    offered = list(before)
    while len(conditions) < MOST_TOGETHER:
        place = len(conditions)
        default = offered[place] if place < len(offered) else ""
        name = _name(conditions, default)
        if not name:
            break
        known = before.get(name)
        source = source_of(known, folder) if known else FILES
        conditions[name] = _source(name, list(conditions), source, folder)
    return conditions


def _name(conditions: Mapping[str, Condition], default: str) -> str:
    """Ask for the next name; empty where there is none."""
    place = len(conditions) + 1
    enough = place > 2

    def read(text: str) -> str:
        if text in ("", "-"):
            if enough:
                return ""
            raise InputError("two conditions at least are compared", remedy="Name another one")
        if text in conditions:
            raise InputError(f"there is a condition {text!r} already", remedy="Name another one")
        if text == "broken":
            raise InputError("'broken' is what catch trials show", remedy="Give it another name")
        return check_name(text, "condition")

    nothing = "'-'" if default else "empty"
    end = f" ({nothing} when there are no more)" if enough else ""
    return ask(Asked(f"Condition {place}{end}", ""), default=default, read=read)


def _source(name: str, earlier: list[str], default: str, folder: Path) -> Condition:
    """Ask where the motion of a condition comes from."""
    names = list(sources())

    def read(text: str) -> Condition:
        kind, colon, of = text.partition(":")
        if kind.isdecimal() and 1 <= int(kind) <= len(names):
            kind = names[int(kind) - 1]
        starts = kind in generator_names() and needs_source(kind)
        if starts and not colon:
            if not earlier:
                raise InputError(
                    f"{kind!r} needs another condition to start from",
                    remedy="Name that one first, and say where it comes from",
                )
            colon, of = ":", earlier[0]
        if starts and of and of not in earlier:
            raise InputError(
                f"there is no condition {of!r} yet", remedy=f"Name one of {', '.join(earlier)}"
            )
        return read_source(f"{kind}{colon}{of}", folder)

    return ask(Asked(f"  {name} comes from", ""), default=default, read=read)


def _reference(
    template: str, conditions: Mapping[str, Condition], before: str | None
) -> str | None:
    """Ask with which condition the others are compared, or which one is shown apart."""
    names = list(conditions)
    first = next((name for name in (before, GROUND_TRUTH) if name in names), None)
    default = first or (names[0] if template == "pairwise" else "-")

    def read(text: str) -> str | None:
        if text == "-" and template == "ranking":
            return None
        if text not in names:
            raise InputError(
                f"{text!r} is none of the conditions", remedy=f"Use one of {', '.join(names)}"
            )
        if template == "ranking" and len(names) < 3:
            raise InputError(
                "without the reference there is nothing to be put in order",
                remedy="Type '-', or leave with Ctrl-C and name more conditions",
            )
        return text

    return ask(reference_asked(template), default=default, read=read)
