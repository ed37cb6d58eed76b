"""What `motionjury check` finds, for programs and people; `findings.toml` declares it all."""

from __future__ import annotations

import textwrap
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
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
    says: str = ""
    where: str = ""
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


def finding(
    name: str, what: str = "", *, where: str = "", remedy: str | None = None, **values: object
) -> Finding:
    """Return that a kind of finding was found.

    Parameters
    ----------
    name : str
        Of its kind.
    what : str
        What is the matter here, as a clause; where it is empty, what the kind says, or means.
    where : str
        A file of the study folder, or a key of the study file; where it is empty, the kind's.
    remedy : str, optional
        What to do here, where that says more than the kind's own remedy.
    **values
        What the kind's clause says in braces; `where` is known to it too.
    """
    kind = kinds()[name]
    return Finding(
        name=name,
        severity=kind.severity,
        where=where or kind.where,
        what=what or kind.says.format(where=where, **values) or kind.means,
        remedy=kind.remedy if remedy is None else remedy,
    )


ALIKE: Final = 3
"""Findings of one kind that are told one by one; of more, the first ones and their number."""

WIDTH: Final = 96


class CheckRecord(BaseModel):
    """What one check found.

    Attributes
    ----------
    format : int
        Changes when a program that reads this would have to.
    study : str
        The study folder's name.
    errors, warnings, notes : int
        How many of each.
    findings : tuple of Finding
        Errors first.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[1] = 1
    study: str
    errors: int
    warnings: int
    notes: int
    findings: tuple[Finding, ...]


def record(study: str, findings: Sequence[Finding]) -> CheckRecord:
    """Return what was found as a program reads it."""
    counts = Counter(found.severity for found in findings)
    return CheckRecord(
        study=study,
        errors=counts["error"],
        warnings=counts["warning"],
        notes=counts["note"],
        findings=tuple(findings),
    )


def told(findings: Sequence[Finding], *, everything: bool = False) -> Iterator[str]:
    """Yield the lines of what was found, as a person reads it.

    Parameters
    ----------
    everything : bool
        Whether notes are told too, and many findings of one kind one by one.
    """
    of_kind: dict[str, list[Finding]] = {}
    for found in findings:
        of_kind.setdefault(found.name, []).append(found)
    for severity in SEVERITIES if everything else SEVERITIES[:-1]:
        for name, alike in of_kind.items():
            if alike[0].severity != severity:
                continue
            told_singly = alike if everything or len(alike) <= ALIKE + 1 else alike[:ALIKE]
            yield f"{severity}: {name}"
            for place, found in enumerate(told_singly):
                following = told_singly[place + 1 : place + 2]
                same = bool(following) and following[0].remedy == found.remedy
                yield from _told(found, remedy="" if same else found.remedy)
            if len(alike) > len(told_singly):
                more = len(alike) - len(told_singly)
                yield f"  and {more} more like these (--verbose tells them)"
            yield ""


def _told(found: Finding, *, remedy: str) -> Iterator[str]:
    where = f"{found.where}: " if found.where and found.where not in found.what else ""
    for text, indent in ((f"{where}{found.what}", "  "), (remedy, "  > ")):
        yield from textwrap.wrap(
            f"{text}." if text else "",
            WIDTH,
            initial_indent=indent,
            subsequent_indent=" " * len(indent),
            break_long_words=False,
            break_on_hyphens=False,
        )


def summed_up(made: CheckRecord) -> str:
    """Return how many errors and warnings there are, in words."""
    counts = ((made.errors, "error"), (made.warnings, "warning"))
    return ", ".join(f"{count} {word}{'' if count == 1 else 's'}" for count, word in counts)
