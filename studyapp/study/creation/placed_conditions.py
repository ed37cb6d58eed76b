"""Putting a study's own conditions into a template: what is compared, and what catches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import tomlkit

from motion.errors import InputError
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.study import GROUND_TRUTH

MOST_TOGETHER: Final = 8
"""Motions that one page can show."""

FEWEST_COMPARED: Final = 2

FEWEST_CATCH_TRIALS: Final = 2
"""Of a study for which videos of a broken motion are brought."""

_WITH_CATCH: Final = ("pairwise", "mismatch")
"""Protocols whose templates have catch trials."""

CHECKS_WITHOUT_CATCH: Final = 2
"""Attention checks of a study that has no flawed motion to show."""


def put_conditions_into(
    document: tomlkit.TOMLDocument,
    protocol: str,
    conditions: Mapping[str, Condition],
    *,
    reference: str | None,
    catch_videos: bool,
) -> None:
    """Replace a template's conditions, and what it says of them elsewhere.

    Parameters
    ----------
    document : TOMLDocument
        The template of `protocol`, which is changed in place.
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
    names = list(conditions)
    if len(names) < FEWEST_COMPARED:
        raise InputError(
            f"{len(names)} condition is nothing to compare", remedy="Name two or more of them"
        )
    if reference is not None and reference not in names:
        raise InputError(
            f"the reference {reference!r} is none of the conditions",
            remedy=f"Use one of {', '.join(names)}",
        )
    _replace(document, conditions)
    if protocol == "pairwise":
        document["reference"] = reference or (GROUND_TRUTH if GROUND_TRUTH in names else names[0])
    elif protocol in ("rating", "ranking"):
        shown = [name for name in names if name != reference or protocol == "rating"]
        _show_together(document, "sets" if protocol == "rating" else "blocks", shown)
    if all(condition.videos for condition in conditions.values()):
        # Nothing in a finished video can be held still.
        document["freeze"] = []
    _catch(document, conditions, catch_videos=catch_videos)
    strengths: Any = document["rehearsal"].get("strength", {})
    for unknown in [name for name in strengths if name not in conditions]:
        del strengths[unknown]


def _replace(document: tomlkit.TOMLDocument, conditions: Mapping[str, Condition]) -> None:
    """Replace the conditions; the comment on what follows them stays before it."""
    old: Any = document["conditions"]
    behind = _comments_behind(list(old.values())[-1])
    table = tomlkit.table(is_super_table=True)
    for name, condition in conditions.items():
        made = condition_table(condition)
        if name != list(conditions)[-1]:
            made.add(tomlkit.nl())
        else:
            for item in behind or [tomlkit.nl()]:
                made.value.append(None, item)
        table[name] = made
    document["conditions"] = table


def _comments_behind(table: Any) -> list[Any]:
    """Return the comments and empty lines at the end of a table."""
    behind: list[Any] = []
    for key, item in reversed(table.value.body):
        if key is not None:
            break
        behind.insert(0, item)
    return behind


def _show_together(document: tomlkit.TOMLDocument, key: str, shown: Sequence[str]) -> None:
    """Let one part of the study show all of `shown` on each page."""
    if not 2 <= len(shown) <= MOST_TOGETHER:
        raise InputError(
            f"a page would show {len(shown)} motions, and it can show 2 to {MOST_TOGETHER}",
            remedy="Name other conditions, or make the study and write parts of your own",
        )
    parts: Any = document[key]
    behind = _comments_behind(parts[-1])
    part = parts[0]
    part["name"] = "all"
    part["conditions"] = list(shown)
    part.pop("shortest", None)
    part.pop("longest", None)
    while len(parts) > 1:
        del parts[-1]
    for item in [] if _comments_behind(part) == behind else behind:
        part.value.append(None, item)


def keys_for(
    protocol: str,
    conditions: Mapping[str, Condition],
    *,
    reference: str | None,
    catch_videos: bool,
) -> dict[str, str | bool]:
    """Return what such conditions need that the template of `protocol` has in a comment.

    Parameters
    ----------
    As of `put_conditions_into`.
    """
    keys: dict[str, str | bool] = {}
    names = list(conditions)
    if protocol == "pairwise" and any(condition.videos for condition in conditions.values()):
        # Finished videos cannot be composed.
        keys["layout"] = "players"
    first = GROUND_TRUTH if GROUND_TRUTH in names else (reference or names[0])
    ranked = [name for name in names if protocol != "ranking" or name != reference]
    if catch_videos:
        keys["videos"] = True
        if first not in ranked and ranked:
            keys["against"] = ranked[0]
        return keys
    moved = [name for name in ranked if not conditions[name].videos]
    if protocol in _WITH_CATCH and moved and first not in moved:
        # Only motion can be broken.
        keys["against"] = moved[0]
    return keys


def _catch(
    document: tomlkit.TOMLDocument,
    conditions: Mapping[str, Condition],
    *,
    catch_videos: bool,
) -> None:
    """Let there be as many catch trials as there is something for: videos, or motion to break."""
    catch: Any = document["catch"]
    moved = any(not condition.videos for condition in conditions.values())
    if catch_videos:
        catch["trials"] = max(int(catch["trials"]), FEWEST_CATCH_TRIALS)
    elif int(catch["trials"]) and not moved:
        catch["trials"] = 0
        attention: Any = document["attention"]
        attention["trials"] = max(int(attention["trials"]), CHECKS_WITHOUT_CATCH)


def condition_table(condition: Condition) -> tomlkit.items.Table:
    """Return a condition as a study file has it."""
    table = tomlkit.table()
    table.update(condition.model_dump(exclude_none=True, exclude_defaults=True))
    return table
