"""What `motionjury check` finds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from motion.errors import InputError


class Severity(Enum):
    """How much a finding matters."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Finding:
    """One finding: what it is, how much it matters, and what to do."""

    severity: Severity
    what: str
    remedy: str = ""


def as_finding(error: InputError) -> Finding:
    """Return an error that makes only a part of the study unusable as a finding."""
    return Finding(Severity.ERROR, f"{error.where}: {error.what}", error.remedy)
