"""What `motionjury check` finds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Severity(Enum):
    """How much a finding matters."""

    ERROR = "error"
    """The study must not be launched."""
    WARNING = "warning"
    """It can be, and somebody should have decided that it may."""
    NOTE = "note"
    """Worth knowing; nothing needs to be done."""


@dataclass(frozen=True, kw_only=True)
class FindingKind:
    """One thing that can be found.

    Attributes
    ----------
    name : str
        Small letters and hyphens; it never changes, so that programs can look for it.
    severity : Severity
    means : str
        What it means, as a clause.
    remedy : str
        What to do, as a sentence without a full stop; empty where nothing needs to be done.
    """

    name: str
    severity: Severity
    means: str
    remedy: str = ""

    def found(self, what: str, *, where: str = "", remedy: str | None = None) -> Finding:
        """Return that it was found.

        Parameters
        ----------
        what : str
            What is the matter here, as a clause.
        where : str
            A file of the study folder, or a key of the study file.
        remedy : str, optional
            What to do here, where that says more than the kind's own remedy.
        """
        return Finding(
            kind=self, what=what, where=where, remedy=self.remedy if remedy is None else remedy
        )


def error(name: str, means: str, remedy: str) -> FindingKind:
    """Return a kind of finding with which a study must not be launched."""
    return FindingKind(name=name, severity=Severity.ERROR, means=means, remedy=remedy)


def warning(name: str, means: str, remedy: str) -> FindingKind:
    """Return a kind of finding that somebody should decide about."""
    return FindingKind(name=name, severity=Severity.WARNING, means=means, remedy=remedy)


def note(name: str, means: str, remedy: str = "") -> FindingKind:
    """Return a kind of finding that is worth knowing."""
    return FindingKind(name=name, severity=Severity.NOTE, means=means, remedy=remedy)


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One finding: what it is, where, how much it matters, and what to do."""

    kind: FindingKind
    what: str
    where: str = ""
    remedy: str = ""

    @property
    def name(self) -> str:
        """The kind's name."""
        return self.kind.name

    @property
    def severity(self) -> Severity:
        """How much it matters."""
        return self.kind.severity
