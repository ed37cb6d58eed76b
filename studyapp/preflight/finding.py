"""The findings of `motionjury check`, for programs and people; `findings.toml` declares them."""

import shutil
import textwrap
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from itertools import groupby
from typing import Final, Literal, get_args

from pydantic import BaseModel, ConfigDict, TypeAdapter

from motion.errors import InputError, counted

Severity = Literal["error", "warning", "note"]
SEVERITIES: Final[tuple[Severity, ...]] = get_args(Severity)
"""The worst first."""


class FindingKind(BaseModel):
    """A kind of finding, as `findings.toml` declares it."""

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
        The problem and what to do about it; the wording may change.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    severity: Severity
    where: str
    what: str
    remedy: str


@cache
def catalogue() -> Mapping[str, Mapping[str, FindingKind]]:
    """Return all kinds of findings by subject and name."""
    text = files(__package__).joinpath("findings.toml").read_text("utf-8")
    return TypeAdapter(dict[str, dict[str, FindingKind]]).validate_python(tomllib.loads(text))


@cache
def kinds() -> Mapping[str, FindingKind]:
    """Return all kinds of findings by name."""
    return {name: kind for subject in catalogue().values() for name, kind in subject.items()}


def make_finding(
    name: str, what: str = "", *, where: str = "", remedy: str = "", **values: object
) -> Finding:
    """Return a finding of the kind `name`.

    Parameters
    ----------
    what : str
        The problem as a clause, if the kind has no clause of its own.
    where : str
        A file of the study folder or a key of the study file, instead of the kind's.
    remedy : str
        What to do, instead of the kind's remedy.
    **values
        Fill the braces of the kind's clause; `where` fills them too.
    """
    kind = kinds()[name]
    return Finding(
        name=name,
        severity=kind.severity,
        where=where or kind.where,
        what=what or kind.says.format(where=where, **values) or kind.means,
        remedy=remedy or kind.remedy,
    )


def finding_of_error(name: str, error: InputError, *, where: str | None = None) -> Finding:
    """Return the finding that something could not be read, with the error's words."""
    return make_finding(
        name, error.what, where=error.where if where is None else where, remedy=error.remedy
    )


MOST_SIMILAR: Final = 3
"""Findings of one kind that are printed in full; the others are only counted."""

WIDTH: Final = 96


class CheckRecord(BaseModel):
    """The findings of one check.

    Attributes
    ----------
    format : int
        Changes when programs that read this have to change.
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

    @property
    def summary(self) -> str:
        """The numbers of errors and warnings, in words."""
        return f"{counted(self.errors, 'error')}, {counted(self.warnings, 'warning')}"


def make_record(study: str, findings: Sequence[Finding]) -> CheckRecord:
    """Return the record of a check."""
    counts = Counter(finding.severity for finding in findings)
    return CheckRecord(
        study=study,
        errors=counts["error"],
        warnings=counts["warning"],
        notes=counts["note"],
        findings=tuple(findings),
    )


def text_lines(findings: Sequence[Finding], *, everything: bool = False) -> Iterator[str]:
    """Yield the lines to print, findings of one kind together.

    Parameters
    ----------
    findings : sequence of Finding
        The worst first.
    everything : bool
        Print notes too, and all findings of a kind instead of the first few.
    """
    by_kind: dict[str, list[Finding]] = {}
    for finding in findings:
        by_kind.setdefault(finding.name, []).append(finding)
    for name, similar in by_kind.items():
        severity = similar[0].severity
        if severity == "note" and not everything:
            continue
        printed = similar if everything else similar[:MOST_SIMILAR]
        yield f"{severity}: {name}"
        for remedy, group in groupby(printed, key=lambda finding: finding.remedy):
            for finding in group:
                named = not finding.where or finding.where in finding.what
                yield from _wrap(
                    finding.what if named else f"{finding.where}: {finding.what}", "  "
                )
            yield from _wrap(remedy, "  > ")
        if len(similar) > len(printed):
            yield f"  and {len(similar) - len(printed)} more like these (--verbose prints them)"
        yield ""


def _wrap(sentence: str, indent: str) -> list[str]:
    return textwrap.wrap(
        f"{sentence}." if sentence else "",
        min(WIDTH, shutil.get_terminal_size((WIDTH, 0)).columns),
        initial_indent=indent,
        subsequent_indent=" " * len(indent),
        break_long_words=False,
        break_on_hyphens=False,
    )
