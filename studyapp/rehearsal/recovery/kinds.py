"""What the analysis makes of each kind of simulated participant."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from studyapp.rehearsal.people import Person
from studyapp.rehearsal.simulation.kinds import KINDS, UNSOUND, Kind


@dataclass(frozen=True, kw_only=True)
class KindRecovered:
    """What the analysis makes of one kind of rater.

    Attributes
    ----------
    kind : Kind
        Which.
    came, completed, analysed : int
        How many began, reached the end, and are analysed.
    silent : int
        How many gave no answer, so that there is nothing of theirs to leave out.
    excluded_by : mapping of rule to int
        How many each rule leaves out.
    """

    kind: Kind
    came: int
    completed: int
    analysed: int
    silent: int
    excluded_by: Mapping[str, int]

    @property
    def excluded(self) -> int:
        """How many are left out by any rule."""
        return sum(self.excluded_by.values())

    @property
    def should_be_left_out(self) -> bool:
        """Whether an analysis is better off without them."""
        return self.kind in UNSOUND or self.kind == "dropping_out"

    @property
    def missed(self) -> int:
        """How many are analysed that should not be."""
        return self.analysed if self.should_be_left_out else 0

    @property
    def wrongly_excluded(self) -> int:
        """How many are left out that judged as the attentive do, and finished."""
        return 0 if self.should_be_left_out else self.excluded


def kinds_recovered(
    everybody: Sequence[Person], analysed: Iterable[str], removed_by: Mapping[str, str]
) -> tuple[KindRecovered, ...]:
    """Return what became of each kind that came.

    Parameters
    ----------
    everybody : sequence of Person
        All who began.
    analysed : iterable of str
        Study sessions that are analysed.
    removed_by : mapping of study session to rule
        Those who are left out, and the first rule that did it.
    """
    kept = set(analysed)
    found = []
    for kind in reversed(KINDS):
        own = [person for person in everybody if person.rater.kind == kind]
        if not own:
            continue
        numbers = [person.study_session for person in own]
        rules = Counter(removed_by[number] for number in numbers if number in removed_by)
        among = sum(number in kept for number in numbers)
        found.append(
            KindRecovered(
                kind=kind,
                came=len(own),
                completed=sum(person.completed for person in own),
                analysed=among,
                silent=len(own) - among - rules.total(),
                excluded_by=dict(sorted(rules.items())),
            )
        )
    return tuple(found)
