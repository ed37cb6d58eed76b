"""Keys that a template has in a comment, and that a study states."""

from __future__ import annotations

import re
from collections.abc import Mapping

import tomlkit

Value = str | int | bool


def stated(text: str, values: Mapping[str, Value], *, table: str = "") -> str:
    """Return a template in which keys stand that it has in a comment.

    Parameters
    ----------
    text : str
        The template; what is said behind a key stays there.
    values : mapping of str to str or int
        What the keys say; where there are none, nothing changes.
    table : str
        The table whose heading is in a comment too, above them; empty where only the keys are.

    Raises
    ------
    ValueError
        If the template has no such comment.
    """
    if not values:
        return text
    start = end = 0
    if table:
        heading = re.search(rf"^# (\[{re.escape(table)}\])\n(?:#.*\n)*", text, re.MULTILINE)
        if heading is None:
            raise ValueError(f"the template has no [{table}] in a comment")
        start, end = heading.span()
    block = text[start:end] if table else text
    if table:
        block = block.replace(f"# [{table}]\n", f"[{table}]\n", 1)
    for key, value in values.items():
        line = re.compile(rf'^# {key} = (?:"[^"\n]*"|[\w.]+)', re.MULTILINE)
        said = f"{key} = {tomlkit.item(value).as_string()}"
        block, times = line.subn(lambda _, said=said: said, block, count=1)  # type: ignore[misc]
        if not times:
            raise ValueError(f"the template has no {key} in a comment")
    return f"{text[:start]}{block}{text[end:]}" if table else block
