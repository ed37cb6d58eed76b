"""What a study's report is told to decide by, and whether it was stated beforehand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from motion.errors import InputError
from studyapp.study.settings.study import Study

Value = TypeVar("Value", float, str)


@dataclass(frozen=True, kw_only=True)
class Agreed(Generic[Value]):
    """A setting of the report.

    Attributes
    ----------
    value : float, str or None
        The margin of equivalence or the family of tests; None where nothing is stated.
    notes : tuple of str
        Where it was not stated beforehand, in sentences.
    """

    value: Value | None
    notes: tuple[str, ...] = ()


def agreed_on(
    key: str,
    stated: Value | None,
    stated_before: Value | None,
    given: Value | None,
    *,
    known: Study | None,
) -> Agreed[Value]:
    """Return a setting of a study's report.

    Parameters
    ----------
    key : str
        Its name in the study file and on the command line.
    stated, stated_before, given
        What the study file says, what it said when the first participant came, and what the
        command line says.
    known : Study or None
        The study as it was when its first participant came; None where that is not known.

    Raises
    ------
    InputError
        If the study file and the command line contradict each other.
    """
    if stated is not None and given is not None and stated != given:
        raise InputError(
            f"--{key} {given} contradicts the study file, which states {stated}",
            where=f"--{key}",
            remedy="Leave the option out",
        )
    value = given if stated is None else stated
    if value is None:
        return Agreed(value=None)
    name = f"The margin of {value:g}" if isinstance(value, float) else f"The {key} “{value}”"
    if stated is None:
        note = f"{name} was given with the report, not in the study file"
    elif known is not None and stated_before != stated:
        note = f"{name} was not in the study file when the first participant came"
    else:
        return Agreed(value=value)
    return Agreed(value=value, notes=(f"{note}: its tests are exploratory.",))
