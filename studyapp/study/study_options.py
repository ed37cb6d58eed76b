"""The options of a new study, and the template variables that follow from its conditions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import tomlkit

from motion.errors import InputError
from motion.segment import check_name
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.presentation import Framing, Language
from studyapp.study.settings.recruitment import Channel, Pay
from studyapp.study.settings.study import GROUND_TRUTH


@dataclass(frozen=True, kw_only=True)
class StudyOptions:
    """What a study file is made from; None leaves the template's own value.

    Attributes
    ----------
    name : str
        The study's name.
    template : str
        One of `studyapp.study.study_file.TEMPLATES`.
    language : {'en', 'de', 'ja'}
        Language of the participants' pages.
    title : str or None
        The title that participants see.
    reference : str or None
        In pairwise studies, the condition that every other one is compared with; also the source
        of the template's mismatched condition. In rankings, the condition that is not ranked.
    trials : int or None
        Pairs that each participant judges; for pairwise studies.
    participants : int or None
        In pairwise studies, for each comparison.
    conditions : mapping of str to Condition, or None
        Replaces the template's conditions.
    catch_videos : bool
        Whether there will be finished videos of a visibly broken motion for catch trials.
    channel : {'link', 'prolific', 'mturk', 'invitations'} or None
        Where participants come from.
    pay : Pay or None
        The pay of each participant.
    minutes : int or None
        Duration of the study.
    organisation, contact, ethics : str or None
        See `studyapp.study.settings.presentation.Page`.
    avatar : str or None
        The avatar in the videos.
    framing : {'upper_body', 'full_body', 'face', 'hands'} or None
        What the videos show; None for the face if every question is about it, otherwise for what
        the template has.
    wording : mapping of str to str
        Question texts that replace the template's, by question name.
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
    framing: Framing | None = None
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
    """Return the variables of the template of `protocol` for conditions that replace its own.

    Parameters
    ----------
    reference : str or None
        The condition that all others are compared with, or that is not ranked.
    catch_videos : bool
        Whether there will be finished videos of a broken motion.

    Raises
    ------
    InputError
        If there are too few or too many conditions, or the reference is not one of them.
    """
    names = [check_name(name, "condition") for name in conditions]
    if len(names) < MIN_CONDITIONS:
        raise InputError("one condition cannot be compared", remedy="Name at least two")
    if reference is not None and reference not in names:
        raise InputError(
            f"the reference {reference!r} is not one of the conditions",
            remedy=f"Use one of {', '.join(names)}",
        )
    has_motion = any(not condition.videos for condition in conditions.values())
    variables: dict[str, Any] = {
        "names": names,
        "conditions": conditions_text(conditions),
        "nothing_breaks": not has_motion and not catch_videos,
        **_catch_variables(protocol, conditions, reference, catch_videos=catch_videos),
    }
    if not has_motion:
        # Nothing in a finished video can be held still.
        variables["freeze"] = []
    if protocol == "pairwise":
        variables["reference"] = reference or (GROUND_TRUTH if GROUND_TRUTH in names else names[0])
        if any(condition.videos for condition in conditions.values()):
            # Finished videos cannot be composed.
            variables["layout"] = "players"
    elif protocol in ("rating", "ranking"):
        shown = [name for name in names if name != reference or protocol == "rating"]
        if not 2 <= len(shown) <= MAX_VIDEOS_PER_PAGE:
            raise InputError(
                f"a page would show {len(shown)} motions, but it can show 2 to "
                f"{MAX_VIDEOS_PER_PAGE}",
                remedy="Name other conditions, or create the study and edit its parts",
            )
        variables["shown"] = shown
    return variables


def _catch_variables(
    protocol: str,
    conditions: Mapping[str, Condition],
    reference: str | None,
    *,
    catch_videos: bool,
) -> dict[str, str | bool]:
    """Return the keys of catch trials that differ from the template's."""
    names = list(conditions)
    default = GROUND_TRUTH if GROUND_TRUTH in names else (reference or names[0])
    judged = [name for name in names if protocol != "ranking" or name != reference]
    if catch_videos:
        return {"videos": True, **({"against": judged[0]} if default not in judged else {})}
    with_motion = [name for name in judged if not conditions[name].videos]
    if protocol in _WITH_CATCH and with_motion and default not in with_motion:
        # Only motion can be broken.
        return {"against": with_motion[0]}
    return {}


def conditions_text(conditions: Mapping[str, Condition]) -> str:
    """Return conditions as tables of a study file."""
    tables = {
        name: condition.model_dump(exclude_none=True, exclude_defaults=True)
        for name, condition in conditions.items()
    }
    return tomlkit.dumps({"conditions": tables}).rstrip()
