"""What a study is to be, asked question by question in a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, cast

import click

from motion.errors import InputError
from motion.segment import check_name
from studyapp.command.asking import agree, ask, choose, explain
from studyapp.command.init_options import (
    FILES,
    LONGEST,
    VIDEOS,
    own_generators,
    read_amount,
    read_count,
    read_currency,
    read_source,
    source_of,
)
from studyapp.definition.conditions import Condition
from studyapp.definition.creation import template_participants
from studyapp.definition.page import Language, reaches_somebody
from studyapp.definition.pay import Pay
from studyapp.definition.placed_conditions import MOST_TOGETHER
from studyapp.definition.recruitment import Channel
from studyapp.definition.study import GROUND_TRUTH
from studyapp.definition.wanted_study import WantedStudy

PROTOCOLS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "pairwise": "two motions of the same speech side by side: which one is preferred? As in "
        "AMUSE; for few conditions and small differences",
        "rating": "several motions of one speech on a page, each rated on a scale. As in S2UE; for "
        "absolute judgements of many conditions",
        "ranking": "several motions of one speech put in order, beside the recording. As in "
        "DiffSHEG; for many conditions that plainly differ",
        "mismatch": "one motion with its own and with another speech: which fits? As in GENEA; "
        "whether motion follows speech at all",
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

STAND_INS: Final = "stand-ins"

_SOURCES: Final[Mapping[str, str]] = MappingProxyType(
    {
        FILES: "motion files brought in with 'motionjury import': recordings, a system's output",
        VIDEOS: "finished videos in videos/NAME/; nothing is rendered",
        "rule_based": "made here from the speech: beat gestures by rule",
        "static": "made here: stands still",
        "mismatched": "another condition's motion for another speech: right in kind, wrong in time",
    }
)


@dataclass(frozen=True, kw_only=True)
class _Compared:
    """What is compared."""

    conditions: Mapping[str, Condition] | None
    reference: str | None
    catch_videos: bool = False


def interview(before: WantedStudy) -> WantedStudy:
    """Ask for everything that a study needs; an empty answer takes what stands in brackets.

    Parameters
    ----------
    before : WantedStudy
        What is known already: from options, or from answers that are gone through again.
    """
    click.echo(
        "An empty answer takes what stands in [brackets], '-' takes nothing instead. Ctrl-C "
        "leaves, and writes nothing."
    )
    template = choose(
        "Protocol",
        "What do participants do? Everything else follows from it.",
        PROTOCOLS,
        default=before.template if before.template in PROTOCOLS else "pairwise",
    )
    compared = _conditions(template, before)
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
        conditions=compared.conditions,
        reference=compared.reference,
        catch_videos=compared.catch_videos,
        language=cast(Language, language),
        participants=participants,
    )
    return _told(_recruited(wanted))


def _conditions(template: str, before: WantedStudy) -> _Compared:
    """Ask what is compared."""
    where = choose(
        "Conditions",
        "Conditions are the systems that are compared. Name your own; or begin with stand-ins that "
        "are made here, to try everything before your motion is there.",
        {
            "own": "name them one after the other",
            STAND_INS: "the template's: rule-based and mismatched motion; of ratings and rankings, "
            "still and flawed motion too",
        },
        default="own" if before.conditions else STAND_INS,
    )
    if where == STAND_INS:
        return _Compared(conditions=None, reference=None)
    conditions = _named(before.conditions or {})
    reference = None
    if template in ("pairwise", "ranking"):
        reference = _reference(template, conditions, before.reference)
    catch_videos = bool(conditions) and all(made.videos for made in conditions.values())
    if catch_videos:
        catch_videos = agree(
            "Will you bring videos of a broken motion",
            "Catch trials show a visibly broken motion beside a good one, and tell who does not "
            "watch. Of finished videos none can be made here: they would lie in "
            "videos/broken/. Without them the study has attention checks instead.",
            default=before.catch_videos,
        )
    return _Compared(conditions=conditions, reference=reference, catch_videos=catch_videos)


def _named(before: Mapping[str, Condition]) -> dict[str, Condition]:
    """Ask for names and sources of conditions until there is no more."""
    explain(
        f"Name the conditions as files and tables will: 'ours', 'baseline', and the real recording "
        f"'{GROUND_TRUTH}'. For each, say where its motion comes from: a number, or a name such as "
        f"{', '.join(own_generators())}."
    )
    for number, (source, words) in enumerate(_SOURCES.items(), start=1):
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
        conditions[name] = _source(name, list(conditions), source_of(known) if known else FILES)
    return conditions


def _name(conditions: Mapping[str, Condition], default: str) -> str:
    """Ask for the next name; empty where there is none."""
    place = len(conditions) + 1
    enough = place > 2

    def checked(text: str) -> str:
        name = text.strip()
        try:
            if name in ("", "-"):
                if enough:
                    return ""
                raise InputError("two conditions at least are compared", remedy="Name another one")
            if name in conditions:
                raise InputError(
                    f"there is a condition {name!r} already", remedy="Name another one"
                )
            if name == "broken":
                raise InputError(
                    "'broken' is what catch trials show", remedy="Give it another name"
                )
            return check_name(name, "condition")
        except InputError as wrong:
            raise click.UsageError(str(wrong)) from wrong

    ending = " (empty when there are no more)" if enough and not default else ""
    ending = " ('-' when there are no more)" if enough and default else ending
    answer: str = click.prompt(
        f"Condition {place}{ending}",
        default=default,
        value_proc=checked,
        show_default=bool(default),
    )
    return answer


def _source(name: str, earlier: list[str], default: str) -> Condition:
    """Ask where the motion of a condition comes from."""
    names = list(_SOURCES)

    def read(text: str) -> Condition:
        kind, colon, of = text.partition(":")
        if kind.isdecimal() and 1 <= int(kind) <= len(names):
            kind = names[int(kind) - 1]
        if kind in ("mismatched", "broken") and not colon:
            if not earlier:
                raise InputError(
                    f"{kind!r} needs another condition to start from",
                    remedy="Name that one first, and say where it comes from",
                )
            colon, of = ":", earlier[0]
        if of and of not in earlier:
            raise InputError(
                f"there is no condition {of!r} yet", remedy=f"Name one of {', '.join(earlier)}"
            )
        return read_source(f"{kind}{colon}{of}")

    def checked(text: str) -> Condition:
        try:
            return read(text.strip())
        except InputError as wrong:
            raise click.UsageError(str(wrong)) from wrong

    answer: Condition = click.prompt(f"  {name} comes from", default=default, value_proc=checked)
    return answer


def _reference(
    template: str, conditions: Mapping[str, Condition], before: str | None
) -> str | None:
    """Ask with which condition the others are compared, or which one is shown apart."""
    names = list(conditions)
    first = next((name for name in (before, GROUND_TRUTH) if name in names), None)
    if template == "pairwise":
        why = "Every other condition is compared with the reference, each by people of its own."
        default = first or names[0]
    else:
        why = (
            "The reference is shown apart as a yardstick and not ranked: the real recording. '-' "
            "for none."
        )
        default = first or "-"

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

    return ask("Reference", why, default=default, read=read)


def _recruited(wanted: WantedStudy) -> WantedStudy:
    """Ask where participants come from, what they get and how long it takes."""
    channel = choose(
        "Recruiting",
        "Where do participants come from? It can be changed while the study runs.",
        CHANNELS,
        default=wanted.channel or "link",
    )
    recruiter = channel in ("prolific", "mturk")
    before = wanted.pay or Pay()

    def read(text: str) -> str:
        amount = "" if text == "-" else read_amount(text)
        if recruiter and not amount:
            raise InputError("recruiting sites must be told what participants get")
        return amount

    amount = ask(
        "Pay",
        "What does each participant get, as a number such as 2.50? It is told to participants, and "
        "'motionjury check' says what an hour pays." + ("" if recruiter else " Empty for nothing."),
        default=before.amount,
        read=read,
    )
    currency = "USD" if channel == "mturk" and amount else ""
    if amount and not currency:
        currency = ask(
            "Currency",
            "In which currency? Three letters. On Prolific: that of your account, GBP or USD.",
            default=before.currency or ("GBP" if channel == "prolific" else ""),
            read=read_currency,
        )
    return replace(
        wanted,
        channel=cast(Channel, channel),
        pay=before.model_copy(update={"amount": amount, "currency": currency}) if amount else None,
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
