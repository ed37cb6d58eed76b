"""Putting a network and a real recording into the template of a ranking study."""

from __future__ import annotations

from typing import Any, Final

import tomlkit

from studyapp.study.settings.conditions import Condition

_REFERENCE: Final = '# reference = "ground_truth"\n'
"""How the template names the key that it leaves out."""


def with_reference(template: str, reference: str) -> str:
    """Return the text of the template with the condition `reference` shown apart."""
    return template.replace(_REFERENCE, f'reference = "{reference}"\n', 1)


def put_systems_into(
    document: tomlkit.TOMLDocument, *, reference: str | None, learned: Condition | None
) -> None:
    """Add the conditions of a network and of the reference to a ranking study's template.

    Parameters
    ----------
    document : TOMLDocument
        The template, which is changed in place.
    reference : str or None
        The condition that is shown apart, whose motion will be brought in.
    learned : Condition or None
        A network's. It is ranked first in every block, as the condition called like its generator,
        in place of the block's last stand-in; stand-ins that no block ranks any more go.
    """
    conditions: Any = document["conditions"]
    ordered: dict[str, Any] = dict(conditions)
    behind = []
    if learned is not None:
        name = str(learned.generator)
        blocks: Any = document["blocks"]
        for block in blocks:
            block["conditions"] = [name, *list(block["conditions"])[:-1]]
        ranked = {one for block in blocks for one in block["conditions"]}
        for unused in [one for one in ordered if one not in ranked]:
            behind = [item for key, item in ordered.pop(unused).value.body if key is None]
        ordered = {name: _spaced(condition_table(learned)), **ordered}
    if reference is not None and reference not in ordered:
        ordered[reference] = condition_table(Condition())
    # The comment on what follows the conditions stood behind the last of them.
    for item in behind:
        ordered[list(ordered)[-1]].value.append(None, item)
    table = tomlkit.table(is_super_table=True)
    for name, condition in ordered.items():
        table[name] = condition
    document["conditions"] = table


def _spaced(table: tomlkit.items.Table) -> tomlkit.items.Table:
    """Return a table with an empty line behind it."""
    last: Any = next((one for one in table.values() if isinstance(one, dict)), table)
    last.add(tomlkit.nl())
    return table


def condition_table(condition: Condition) -> tomlkit.items.Table:
    """Return a condition as a study file has it."""
    table = tomlkit.table()
    table.update(condition.model_dump(exclude_none=True, exclude_defaults=True))
    return table
