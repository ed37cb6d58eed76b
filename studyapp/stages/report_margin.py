"""The margin of equivalence of a study's report, and whether it was stated beforehand."""

from __future__ import annotations

from dataclasses import dataclass

from motion.errors import InputError
from studyapp.definition.study import Study


@dataclass(frozen=True, kw_only=True)
class AgreedMargin:
    """The margin to test equivalence against.

    Attributes
    ----------
    margin : float or None
        None where nothing is tested.
    notes : tuple of str
        Where it was not stated beforehand, in sentences.
    """

    margin: float | None
    notes: tuple[str, ...] = ()


def study_margin(stated: float | None, before: Study | None, given: float | None) -> AgreedMargin:
    """Return the margin of a study.

    Parameters
    ----------
    stated : float or None
        What the study file says.
    before : Study or None
        The study as it was when its first participant came, where that is known.
    given : float or None
        What the command line says.

    Raises
    ------
    InputError
        If the study file and the command line contradict each other.
    """
    if stated is not None and given is not None and stated != given:
        raise InputError(
            f"--margin {given:g} contradicts the study file, which states {stated:g}",
            where="--margin",
            remedy="Leave the option out",
        )
    margin = given if stated is None else stated
    if margin is None:
        return AgreedMargin(margin=None)
    if stated is None:
        note = f"The margin of {margin:g} was given with the report, not in the study file"
    elif before is not None and before.margin != stated:
        note = f"The margin of {margin:g} was not in the study file when the first participant came"
    else:
        return AgreedMargin(margin=margin)
    return AgreedMargin(margin=margin, notes=(f"{note}: its tests are exploratory.",))
