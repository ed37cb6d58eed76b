"""What a study is to be, asked in a terminal; nothing is written before it is agreed to."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Final, cast

import click

from motion.errors import InputError
from studyapp.cli.creation.asking import ask, ask_conditions, choose
from studyapp.cli.creation.init_options import (
    LONGEST,
    RECRUITING_SITES,
    read_count,
    read_pay,
)
from studyapp.study.settings.presentation import Language, reaches_somebody
from studyapp.study.settings.reading import ALIASES
from studyapp.study.settings.recruitment import Channel, Pay
from studyapp.study.study_file import drafted, template_participants
from studyapp.study.wanted_study import WantedStudy

_TEMPLATES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "pairwise": "two motions of the same speech side by side: which one is preferred? As in "
        "AMUSE; for few conditions and small differences",
        "rating": "several motions of one speech on a page, each rated on a scale. As in S2UE; for "
        "absolute judgements of many conditions",
        "ranking": "several motions of one speech put in order, beside the recording. As in "
        "DiffSHEG; for many conditions that plainly differ",
        "mismatch": "one motion with its own and with another speech: which fits? As in GENEA; "
        "whether motion follows speech at all",
        "three-systems": "AMUSE, DiffSHEG and Speech2UnifiedExpressions beside rules, mismatched "
        "motion and the recording, in pairs; for networks that you have",
    }
)

LANGUAGES: Final[Mapping[str, str]] = MappingProxyType(
    {"en": "English", "de": "German", "ja": "Japanese"}
)

CHANNELS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "link": "whoever has the study's address; each who finishes gets a code of their own",
        "invitations": "people whom you write to; each gets a link of their own",
        "prolific": "people from Prolific; drafts, places and pay go through its API",
        "mturk": "workers of Mechanical Turk, if you are a requester there already",
    }
)


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
        "Protocol",
        "What do participants do? Everything else follows from it.",
        _TEMPLATES,
        default=ALIASES.get(before.template, before.template),
    )
    before = ask_conditions(template, before, folder)
    language = choose(
        "Language",
        "What do participants read in? The pages, the questions and the consent text follow.",
        LANGUAGES,
        default=before.language,
    )
    each = "for each comparison with the reference" if template == "pairwise" else "in all"
    participants = ask(
        "Participants",
        f"How many take part, {each}? The published studies had as many as stand here; 'motionjury "
        "plan' says how many a difference needs.",
        default=str(before.participants or template_participants(template)),
        read=read_count(10_000, what="participants"),
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
    channel = choose(
        "Recruiting",
        "Where do participants come from? It can be changed while the study runs.",
        CHANNELS,
        default=wanted.channel or "link",
    )
    recruiter = channel in RECRUITING_SITES
    before = wanted.pay or Pay()
    pay = ask(
        "Pay",
        "What does each participant get, as an amount with a currency such as 2.50 EUR? On "
        "Prolific in that of your account, GBP or USD, on Mechanical Turk in USD. It is told to "
        "participants, and 'motionjury check' says what an hour pays."
        + ("" if recruiter else " Empty for nothing."),
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

    why = "How many minutes does it take? 'motionjury check' reckons it from your videos and "
    why += "questions, and says where this is wrong."
    default = str(wanted.minutes) if wanted.minutes else ("20" if recruiter else "")
    return ask(
        "Minutes", why + ("" if recruiter else " Empty for now."), default=default, read=read
    )


def _told(wanted: WantedStudy) -> WantedStudy:
    """Ask for what participants are told before they agree."""
    title = ask(
        "Title",
        "What do participants see as the study's title? It should not tell what you expect.",
        default=wanted.title or "",
        read=lambda text: _text(text, 200) or None,
    )
    organisation = ask(
        "Institution",
        "Who runs the study? Participants read it before they agree.",
        default=wanted.organisation or "",
        read=lambda text: _text(text, 200),
    )
    contact = ask(
        "Contact",
        "Whom can they ask? An e-mail address that somebody reads.",
        default=wanted.contact or "",
        read=_address,
    )
    ethics = ask(
        "Ethics",
        "Who approved the study? The committee and its number; empty if that is still to come.",
        default=wanted.ethics or "",
        read=lambda text: _text(text, 300),
    )
    return replace(wanted, title=title, organisation=organisation, contact=contact, ethics=ethics)


def _text(text: str, longest: int) -> str:
    """Return what was typed, nothing for a dash; `InputError` where it is too long."""
    if text == "-":
        return ""
    if len(text) > longest:
        raise InputError(f"that is longer than {longest} characters", remedy="Say it shorter")
    return text


def _address(text: str) -> str:
    """Return a contact; one that reaches nobody is refused, none at all can be filled in later."""
    if text not in ("", "-") and not reaches_somebody(text):
        raise InputError(
            f"{text!r} does not say how to reach anybody",
            remedy="Give an e-mail address, a page or a telephone number; or nothing for now",
        )
    return _text(text, 200)


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
