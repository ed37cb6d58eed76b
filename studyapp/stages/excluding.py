"""Who is left out of the analysis of a study, and which of the rules were settled beforehand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from analysis.exclusions.rules import ExclusionRule, excluded_by_hand
from motion.listing import listed
from studyapp.definition.exclusions import ExclusionSection


@dataclass(frozen=True, kw_only=True)
class StudyExclusions:
    """The rules of a study, for `analysis.results.left_out.leave_out`.

    Attributes
    ----------
    rules : tuple of ExclusionRule
        In order: of the study file, of researchers who exclude by hand, of the command line.
        Exploratory are the latter two, and those that the study file did not state before the
        first participant came.
    planned : tuple of ExclusionRule
        Those that it did state then.
    notes : tuple of str
        How the rules have changed since, in sentences.
    """

    rules: tuple[ExclusionRule, ...]
    planned: tuple[ExclusionRule, ...]
    notes: tuple[str, ...] = ()


def study_exclusions(
    stated: Sequence[ExclusionSection],
    before: Sequence[ExclusionSection] | None = None,
    added: Sequence[ExclusionSection] = (),
    by_hand: bool = False,
) -> StudyExclusions:
    """Return the exclusion rules of a study, and which of them are exploratory.

    Parameters
    ----------
    stated : sequence of ExclusionSection
        What the study file says, settled.
    before : sequence of ExclusionSection, optional
        What it said before the first participant came (see `stated_study`); without it, as in a
        rehearsal, everything stated counts as settled then.
    added : sequence of ExclusionSection
        Rules that were added afterwards; applied after all others.
    by_hand : bool
        Whether researchers have excluded anybody one by one.
    """
    planned = stated if before is None else before
    then = {each.written() for each in planned}
    return StudyExclusions(
        rules=(
            *(
                each.made() if each.written() in then else each.made().as_exploratory()
                for each in stated
            ),
            *((excluded_by_hand(),) if by_hand else ()),
            *(each.made().as_exploratory() for each in added),
        ),
        planned=tuple(each.made() for each in planned),
        notes=_changes(planned, stated),
    )


def _changes(
    before: Sequence[ExclusionSection], stated: Sequence[ExclusionSection]
) -> tuple[str, ...]:
    then, today = ([each.written() for each in rules] for rules in (before, stated))
    came = [rule for rule in today if rule not in then]
    went = [rule for rule in then if rule not in today]
    notes = []
    if came:
        notes.append(
            f"Exclusion by {listed(came)} was not in the study file when the first participant "
            "came: it is exploratory."
        )
    if went:
        notes.append(
            f"Exclusion by {listed(went)} was in the study file when the first participant came, "
            "and has been taken out of it since."
        )
    return tuple(notes)
