"""How a value is written in each kind of file, so that it stays one value.

Templates put a value that could hold anything within double quotes (in scripts, single ones).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final


def in_unit(text: str) -> str:
    """Return `text` for a quoted value of systemd's units; ``%`` begins a specifier there."""
    return _behind_backslashes(" ".join(text.split())).replace("%", "%%")


def in_proxy(text: str) -> str:
    """Return `text` for a quoted value of Caddy's or nginx's files."""
    return _behind_backslashes(text)


def in_script(text: str) -> str:
    """Return `text` for between two single quotes of a shell script."""
    return text.replace("'", "'\\''")


def in_sql(text: str) -> str:
    """Return `text` for a quoted name or string of SQL."""
    return text.replace('"', '""').replace("'", "''")


def as_it_is(text: str) -> str:
    """Return `text`; such a file holds nothing but values of a known alphabet."""
    return text


def _behind_backslashes(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')


Escape = Callable[[str], str]

ESCAPES: Final[Mapping[str, Escape]] = MappingProxyType(
    {
        ".service": in_unit,
        ".timer": in_unit,
        ".caddy": in_proxy,
        ".nginx": in_proxy,
        ".sh": in_script,
        ".sql": in_sql,
        ".env": as_it_is,
        ".conf": as_it_is,
        ".container": as_it_is,
    }
)
"""By the ending of a template."""
