"""Asking one thing in a terminal: a sentence why, an answer that is checked at once."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from typing import Final, TypeVar

import click

from motion.errors import InputError

T = TypeVar("T")

WIDTH: Final = 88


def explain(text: str) -> None:
    """Print a paragraph."""
    click.echo()
    click.echo(textwrap.fill(text, WIDTH))


def ask(question: str, why: str = "", *, default: str = "", read: Callable[[str], T]) -> T:
    """Ask until `read` accepts the answer, and return what it makes of it.

    Parameters
    ----------
    question : str
        Without a question mark at its end.
    why : str
        What it is for; printed once, before it, where there is something to be said.
    default : str
        What an empty answer means.
    read : callable
        Raises `InputError` with what is wrong; it is printed, and asked again.
    """
    if why:
        explain(why)

    def checked(text: str) -> T:
        try:
            return read(text.strip())
        except InputError as wrong:
            raise click.UsageError(str(wrong)) from wrong

    answer: T = click.prompt(
        question, default=default, value_proc=checked, show_default=bool(default)
    )
    return answer


def choose(question: str, why: str, offered: Mapping[str, str], *, default: str) -> str:
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

    explain(why)
    for number, (name, words) in enumerate(offered.items(), start=1):
        lines = textwrap.wrap(words, WIDTH - width - 7)
        click.echo(f"  {number}  {name:{width}}  {lines[0]}")
        for line in lines[1:]:
            click.echo(f"{'':{width + 7}}{line}")
    return ask(question, default=default, read=chosen)


def agree(question: str, why: str, *, default: bool) -> bool:
    """Ask for a yes or a no."""
    explain(why)
    return click.confirm(question, default=default)
