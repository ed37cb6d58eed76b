"""Parts of a study session that show conditions of their own: sets and blocks."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from pydantic import Field

from studyapp.study.settings.section import Name, Section


class Part(Section):
    """One part of a study session.

    Attributes
    ----------
    name : str
        Names it in questions and in the export.
    conditions : tuple of str
        What is shown together on each of its pages.
    """

    name: Name
    conditions: tuple[Name, ...] = Field(min_length=2, max_length=8, strict=False)


def part_problems(key: str, parts: Sequence[Part], conditions: Collection[str]) -> list[str]:
    """Return what is wrong with the `parts` under `key` of a study with these conditions."""
    problems = []
    names = [part.name for part in parts]
    if len(set(names)) != len(names):
        problems.append(f"{key}: two have the same name")
    for part in parts:
        unknown = [name for name in part.conditions if name not in conditions]
        if unknown:
            known = ", ".join(conditions)
            problems.append(f"{key}.{part.name}: {unknown[0]!r} is no condition ({known})")
        if len(set(part.conditions)) != len(part.conditions):
            problems.append(f"{key}.{part.name}: a condition is named twice")
    return problems
