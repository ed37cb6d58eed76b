"""What a check found, for programs and for people."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Final, Literal

from pydantic import BaseModel, ConfigDict

from motion.listing import listed
from studyapp.preflight.finding import SEVERITIES, Finding

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
        Whether many findings of one kind are told one by one.
    """
    of_kind: dict[str, list[Finding]] = {}
    for found in findings:
        of_kind.setdefault(found.name, []).append(found)
    for severity in SEVERITIES:
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
                yield f"  and {len(alike) - len(told_singly)} more like these (--all tells them)"
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
    """Return how many findings there are, in words."""
    counts = ((made.errors, "error"), (made.warnings, "warning"), (made.notes, "note"))
    said = [f"{count} {word}{'' if count == 1 else 's'}" for count, word in counts if count]
    return listed(said) or "nothing found"
