"""What a study is to be, asked in a terminal; nothing is written before it is agreed to."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final, cast

import click

from motion.errors import InputError
from studyapp.cli.creation.asking import ask, ask_conditions, choose
from studyapp.study.interview import (
    CHANNELS,
    LANGUAGES,
    LONGEST,
    MOST_PARTICIPANTS,
    QUESTIONS,
    RECRUITING_SITES,
    TEMPLATE_WORDS,
    Asked,
    participants_asked,
    read_address,
    read_count,
    read_line,
    read_pay,
)
from studyapp.study.settings.presentation import Language
from studyapp.study.settings.reading import ALIASES
from studyapp.study.settings.recruitment import Channel, Pay
from studyapp.study.study_file import drafted, template_participants
from studyapp.study.wanted_study import WantedStudy


def interview(before: WantedStudy, folder: Path) -> WantedStudy:
    """Ask for everything that a study needs; an empty answer takes what stands in brackets.

    Parameters
    ----------
    before : WantedStudy
        What is known already: from options, or from answers that are gone through again.
    folder : Path
        The study's, from which files are named.
    """
    click.echo(
        "An empty answer takes what stands in [brackets], '-' takes nothing instead. Ctrl-C "
        "leaves, and writes nothing."
    )
    template = choose(
        QUESTIONS["template"], TEMPLATE_WORDS, default=ALIASES.get(before.template, before.template)
    )
    before = ask_conditions(template, before, folder)
    language = choose(QUESTIONS["language"], LANGUAGES, default=before.language)
    participants = ask(
        participants_asked(template),
        default=str(before.participants or template_participants(template)),
        read=read_count(MOST_PARTICIPANTS, what="participants"),
    )
    wanted = replace(
        before,
        template=template,
        language=cast(Language, language),
        participants=participants,
    )
    return _told(_recruited(wanted))


def _recruited(wanted: WantedStudy) -> WantedStudy:
    """Ask where participants come from, what they get and how long it takes."""
    channel = choose(QUESTIONS["channel"], CHANNELS, default=wanted.channel or "link")
    recruiter = channel in RECRUITING_SITES
    before = wanted.pay or Pay()
    pay = ask(
        QUESTIONS["pay"],
        "" if recruiter else " Empty for nothing.",
        default=f"{before.amount} {before.currency}".strip(),
        read=lambda text: read_pay(text, channel),
    )
    return replace(
        wanted,
        channel=cast(Channel, channel),
        pay=pay,
        minutes=_minutes(wanted, recruiter=recruiter),
    )


def _minutes(wanted: WantedStudy, *, recruiter: bool) -> int | None:
    count = read_count(LONGEST, what="minutes")

    def read(text: str) -> int | None:
        if text in ("", "-") and not recruiter:
            return None
        return count(text)

    default = str(wanted.minutes) if wanted.minutes else ("20" if recruiter else "")
    return ask(
        QUESTIONS["minutes"], "" if recruiter else " Empty for now.", default=default, read=read
    )


def _told(wanted: WantedStudy) -> WantedStudy:
    """Ask for what participants are told before they agree."""
    title = ask(
        QUESTIONS["title"],
        default=wanted.title or "",
        read=lambda text: read_line(text, 200) or None,
    )
    organisation = ask(
        QUESTIONS["organisation"],
        default=wanted.organisation or "",
        read=lambda text: read_line(text, 200),
    )
    contact = ask(QUESTIONS["contact"], default=wanted.contact or "", read=read_address)
    ethics = ask(
        QUESTIONS["ethics"],
        default=wanted.ethics or "",
        read=lambda text: read_line(text, 300),
    )
    return replace(wanted, title=title, organisation=organisation, contact=contact, ethics=ethics)


_NOW: Final = Asked("Then", "What now?")
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
        while (then := choose(_NOW, _THEN, default=_WRITE)) == _LOOK:
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
