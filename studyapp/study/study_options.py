"""What a new study is to be, and what its template is told of its own conditions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import tomlkit

from motion.errors import InputError
from motion.segment import check_name
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.presentation import Language
from studyapp.study.settings.recruitment import Channel, Pay
from studyapp.study.settings.study import GROUND_TRUTH


@dataclass(frozen=True, kw_only=True)
class StudyOptions:
    """What a study file is made from; what is None stays as its template has it.

    Attributes
    ----------
    name : str
        The study's name.
    template : str
        One of `studyapp.study.study_file.TEMPLATES`.
    language : {'en', 'de', 'ja'}
        What participants read in.
    title : str or None
        What participants see as its title.
    reference : str or None
        The condition every other one is compared with; also the source of the template's
        mismatched condition. For pairwise studies. For rankings, the condition that is shown
        apart.
    trials : int or None
        Pairs each participant judges. For pairwise studies.
    participants : int or None
        How many; of pairwise studies, for each comparison.
    conditions : mapping of str to Condition, or None
        Replaces the template's conditions.
    catch_videos : bool
        Whether finished videos of a visibly broken motion will be brought for catch trials.
    channel : {'link', 'prolific', 'mturk', 'invitations'} or None
        Where participants come from.
    pay : Pay or None
        What each of them gets.
    minutes : int or None
        How long it takes.
    organisation, contact, ethics : str or None
        See `studyapp.study.settings.presentation.Page`.
    avatar : str or None
        Who moves in the videos.
    wording : mapping of str to str
        Texts of questions in place of the template's, by the questions' names.
    """

    name: str
    template: str = "pairwise"
    language: Language = "en"
    title: str | None = None
    reference: str | None = None
    trials: int | None = None
    participants: int | None = None
    conditions: Mapping[str, Condition] | None = None
    catch_videos: bool = False
    channel: Channel | None = None
    pay: Pay | None = None
    minutes: int | None = None
    organisation: str | None = None
    contact: str | None = None
    ethics: str | None = None
    avatar: str | None = None
    wording: Mapping[str, str] = field(default_factory=dict)


MAX_VIDEOS_PER_PAGE: Final = 8
"""Motions that one page can show."""

MIN_CONDITIONS: Final = 2

_WITH_CATCH: Final = ("pairwise", "mismatch")
"""Protocols whose templates have catch trials."""


def condition_variables(
    protocol: str,
    conditions: Mapping[str, Condition],
    *,
    reference: str | None,
    catch_videos: bool,
) -> dict[str, Any]:
    """Return what the template of `protocol` is told of conditions that replace its own.

    Parameters
    ----------
    conditions : mapping of str to Condition
        In their order.
    reference : str or None
        The condition that all others are compared with, or that is shown apart.
    catch_videos : bool
        Whether finished videos of a broken motion will be brought.

    Raises
    ------
    InputError
        If they are too few or too many, or the reference is none of them.
    """
    names = [check_name(name, "condition") for name in conditions]
    if len(names) < MIN_CONDITIONS:
        raise InputError(
            f"{len(names)} condition is nothing to compare", remedy="Name two or more of them"
        )
    if reference is not None and reference not in names:
        raise InputError(
            f"the reference {reference!r} is none of the conditions",
            remedy=f"Use one of {', '.join(names)}",
        )
    moved = any(not condition.videos for condition in conditions.values())
    stated: dict[str, Any] = {
        "names": names,
        "conditions": conditions_text(conditions),
        "nothing_breaks": not moved and not catch_videos,
        **_catch_variables(protocol, conditions, reference, catch_videos=catch_videos),
    }
    if not moved:
        # Nothing in a finished video can be held still.
        stated["freeze"] = []
    if protocol == "pairwise":
        stated["reference"] = reference or (GROUND_TRUTH if GROUND_TRUTH in names else names[0])
        if any(condition.videos for condition in conditions.values()):
            # Finished videos cannot be composed.
            stated["layout"] = "players"
    elif protocol in ("rating", "ranking"):
        shown = [name for name in names if name != reference or protocol == "rating"]
        if not 2 <= len(shown) <= MAX_VIDEOS_PER_PAGE:
            raise InputError(
                f"a page would show {len(shown)} motions, but it can show 2 to "
                f"{MAX_VIDEOS_PER_PAGE}",
                remedy="Name other conditions, or make the study and write parts of your own",
            )
        stated["shown"] = shown
    return stated


def _catch_variables(
    protocol: str,
    conditions: Mapping[str, Condition],
    reference: str | None,
    *,
    catch_videos: bool,
) -> dict[str, str | bool]:
    """Return what catch trials show, where it is not what the template says."""
    names = list(conditions)
    first = GROUND_TRUTH if GROUND_TRUTH in names else (reference or names[0])
    ranked = [name for name in names if protocol != "ranking" or name != reference]
    if catch_videos:
        return {"videos": True, **({"against": ranked[0]} if first not in ranked else {})}
    moved = [name for name in ranked if not conditions[name].videos]
    if protocol in _WITH_CATCH and moved and first not in moved:
        # Only motion can be broken.
        return {"against": moved[0]}
    return {}


def conditions_text(conditions: Mapping[str, Condition]) -> str:
    """Return conditions as a study file has them."""
    tables = {
        name: condition.model_dump(exclude_none=True, exclude_defaults=True)
        for name, condition in conditions.items()
    }
    return tomlkit.dumps({"conditions": tables}).rstrip()
