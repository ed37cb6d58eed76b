"""Who is left out of the analysis of a study, and which of the rules were settled beforehand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from analysis.exclusions.rules import ExclusionRule
from analysis.exclusions.sitting import KnownSitting
from motion.listing import listed
from studyapp.definition.exclusions import ExclusionSection
from studyapp.definition.study import Study
from studyapp.services.database import Database
from studyapp.services.known_sittings import known_sittings, rules_before_answers


@dataclass(frozen=True, kw_only=True, eq=False)
class StudyExclusions:
    """What `analysis.results.left_out.leave_out` needs of a study.

    Attributes
    ----------
    rules : tuple of ExclusionRule
        In order; exploratory are those of the command line, and those that the study file did
        not state when the first participant came.
    planned : tuple of ExclusionRule
        Those that it did state then.
    known : mapping of study session to KnownSitting
        What the study knows beside the answers.
    notes : tuple of str
        How the rules have changed since, in sentences.
    """

    rules: tuple[ExclusionRule, ...]
    planned: tuple[ExclusionRule, ...]
    known: Mapping[str, KnownSitting] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def study_exclusions(
    study: Study,
    database: Database | None,
    *,
    real: bool,
    added: Sequence[ExclusionSection] = (),
) -> StudyExclusions:
    """Return the exclusion rules of `study` and the facts they decide from.

    Parameters
    ----------
    study : Study
        As its file says.
    database : Database or None
        The answers; None where there are none yet.
    real : bool
        Whether participants gave them: of a rehearsal, every rule of the file is settled.
    added : sequence of ExclusionSection
        Rules that were added afterwards; exploratory, applied after those of the file.
    """
    stated = study.settled_exclusions
    before = rules_before_answers(database) if real and database is not None else None
    settled = stated if before is None else before
    known_then = {each.written() for each in settled}
    return StudyExclusions(
        rules=(
            *(
                each.made() if each.written() in known_then else each.made().as_exploratory()
                for each in stated
            ),
            *(each.made().as_exploratory() for each in added),
        ),
        planned=tuple(each.made() for each in settled),
        known={} if database is None else known_sittings(database, study),
        notes=_changes(settled, stated),
    )


def _changes(
    before: Sequence[ExclusionSection], stated: Sequence[ExclusionSection]
) -> tuple[str, ...]:
    then, today = ([each.written() for each in rules] for rules in (before, stated))
    came = [rule for rule in today if rule not in then]
    went = [rule for rule in then if rule not in today]
    since = "since the first participant came"
    return (
        *(
            (f"The study file states {listed(came)} as exclusion only {since}: exploratory.",)
            if came
            else ()
        ),
        *(
            (f"The exclusion {listed(went)} was taken out of the study file {since}.",)
            if went
            else ()
        ),
    )
