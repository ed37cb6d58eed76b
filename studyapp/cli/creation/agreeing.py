"""Asking what a study is to be, and writing nothing before somebody has agreed to it."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import click

from motion.errors import InputError
from studyapp.cli.creation.asking import choose
from studyapp.cli.creation.interview import LANGUAGES, interview
from studyapp.study.creation.study_file import drafted
from studyapp.study.creation.wanted_study import WantedStudy

_WRITE, _LOOK, _CHANGE, _LEAVE = "write", "look", "change", "leave"

_THEN: Final = {
    _WRITE: "write it",
    _LOOK: "show the whole file first",
    _CHANGE: "go through the questions again, with these answers in [brackets]",
    _LEAVE: "leave, and write nothing",
}


def agreed(wanted: WantedStudy, where: Path) -> str:
    """Ask, show what would be written, and return the text of the study file once it is agreed to.

    Parameters
    ----------
    wanted : WantedStudy
        First answers.
    where : Path
        Where it would be written.

    Raises
    ------
    click.exceptions.Exit
        If it is not wanted after all.
    """
    while True:
        wanted = interview(wanted, where.parent)
        try:
            text = drafted(wanted, where=where)
        except InputError as wrong:
            click.echo(f"\nThese answers make no study: {wrong}\nOnce more:\n")
            continue
        plain = WantedStudy(name=wanted.name, template=wanted.template, language=wanted.language)
        click.echo(
            f"\n{where} will be the template {wanted.template!r} in {LANGUAGES[wanted.language]}, "
            "which explains every key, with:\n"
        )
        for line in decided(drafted(plain, where=where), text):
            click.echo(f"  {line}")
        while (then := choose("Then", "What now?", _THEN, default=_WRITE)) == _LOOK:
            click.echo_via_pager(text)
        if then == _WRITE:
            return text
        if then == _LEAVE:
            click.echo("Nothing was written.")
            raise click.exceptions.Exit(1)
        click.echo()


def decided(template: str, text: str) -> Iterator[str]:
    """Yield the lines that answers have put into a study file, each under its table's heading.

    Of a table that the template does not have, all lines are told.
    """
    old, new = template.splitlines(), text.splitlines()
    added = {
        line
        for kind, _, _, first, last in difflib.SequenceMatcher(
            None, old, new, autojunk=False
        ).get_opcodes()
        if kind in ("replace", "insert")
        for line in range(first, last)
    }
    known = set(old)
    heading, told, is_new = "", "", False
    for number, line in enumerate(new):
        if line.startswith("["):
            heading, is_new = line, line not in known
        if not line.strip() or line.startswith("#") or not (is_new or number in added):
            continue
        if heading != told and line != heading:
            yield heading
        told = heading
        yield line
