"""What `motionjury check` finds; `findings.toml` declares all there is to find."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Final, Literal, get_args

from pydantic import BaseModel, ConfigDict, TypeAdapter

Severity = Literal["error", "warning", "note"]
SEVERITIES: Final[tuple[Severity, ...]] = get_args(Severity)
"""The worst first."""


class FindingKind(BaseModel):
    """One thing that can be found, as `findings.toml` declares it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    severity: Severity
    means: str
    remedy: str = ""


class Finding(BaseModel):
    """One finding.

    Attributes
    ----------
    name : str
        Its kind, as in the table of `docs/check.md`; it never changes.
    where : str
        A file of the study folder, or a key of the study file; may be empty.
    what, remedy : str
        What is the matter and what to do; wording may change.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    severity: Severity
    where: str
    what: str
    remedy: str


@cache
def catalogue() -> Mapping[str, Mapping[str, FindingKind]]:
    """Return every kind of finding under its name, by where it is looked for."""
    text = files(__package__).joinpath("findings.toml").read_text("utf-8")
    return TypeAdapter(dict[str, dict[str, FindingKind]]).validate_python(tomllib.loads(text))


@cache
def kinds() -> Mapping[str, FindingKind]:
    """Return every kind of finding under its name."""
    return {name: kind for own in catalogue().values() for name, kind in own.items()}


def finding(name: str, what: str = "", *, where: str = "", remedy: str | None = None) -> Finding:
    """Return that a kind of finding was found.

    Parameters
    ----------
    name : str
        Of its kind.
    what : str
        What is the matter here, as a clause; where it is empty, what the kind means.
    where : str
        A file of the study folder, or a key of the study file.
    remedy : str, optional
        What to do here, where that says more than the kind's own remedy.
    """
    kind = kinds()[name]
    return Finding(
        name=name,
        severity=kind.severity,
        where=where,
        what=what or kind.means,
        remedy=kind.remedy if remedy is None else remedy,
    )
