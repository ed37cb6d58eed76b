"""The participant flow: who came, who was left out by which rule, who is analysed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from analysis.answers.table import AnswerTable
from analysis.results.left_out import LeftOut

EVERYBODY: Final = ""
"""The arm of a table, and of a study that has one."""


@dataclass(frozen=True, kw_only=True)
class ArmState:
    """What a study knows of the participants of one arm.

    Attributes
    ----------
    arm : str
        Its name; `EVERYBODY` where there is one.
    places : int or None
        How many participants it waits for; None for an arm that the study no longer has.
    opened : int
        Study sessions begun.
    withdrawn, earlier : int
        Those of them whose participants withdrew; that belong to an earlier design of the study
        and are not analysed.
    unwatched : int
        Those that ended before, since too many videos were said not to play.
    completed : int
        Those of all others that reached the end.
    """

    arm: str
    places: int | None
    opened: int
    withdrawn: int
    earlier: int
    unwatched: int
    completed: int


@dataclass(frozen=True, kw_only=True)
class Flow:
    """The participants of one arm, from their arrival to the analysis.

    Attributes
    ----------
    arm : str
        Its name; empty for a table, and for a study with one arm.
    places, opened, withdrawn, earlier, unwatched, completed : int or None
        As in `ArmState`; None for a table.
    answered : int
        How many gave an answer, and did not withdraw.
    removed : tuple of int
        How many of them each rule removed, in the order of the rules.
    analysed : int
        How many every rule kept.
    """

    arm: str
    places: int | None = None
    opened: int | None = None
    withdrawn: int | None = None
    earlier: int | None = None
    unwatched: int | None = None
    completed: int | None = None
    answered: int
    removed: tuple[int, ...]
    analysed: int

    @property
    def silent(self) -> int | None:
        """How many came and are there, but gave no answer."""
        if self.opened is None or self.withdrawn is None or self.earlier is None:
            return None
        return self.opened - self.withdrawn - self.earlier - self.answered


def participant_flow(
    table: AnswerTable,
    left_out: LeftOut,
    arms: Sequence[ArmState] = (),
    arm_of: Mapping[str, str] | None = None,
) -> tuple[Flow, ...]:
    """Count participants arm by arm.

    Parameters
    ----------
    table : AnswerTable
        Who answered.
    left_out : LeftOut
        What the rules did.
    arms : sequence of ArmState
        Of a study; without any, everybody is in one arm.
    arm_of : mapping of str to str
        The arm of each participant.
    """
    belongs = arm_of or {}
    answered = Counter(belongs.get(who, EVERYBODY) for who in table.participants)
    removed = Counter(
        (belongs.get(who, EVERYBODY), place) for who, place in left_out.removed_by.items()
    )
    flows = []
    for name in dict.fromkeys((*(one.arm for one in arms), *answered)) or (EVERYBODY,):
        known = next((vars(one) for one in arms if one.arm == name), {"arm": name})
        counts = tuple(removed[name, place] for place in range(len(left_out.rules)))
        flows.append(
            Flow(
                **known,
                answered=answered[name],
                removed=counts,
                analysed=answered[name] - sum(counts),
            )
        )
    return tuple(flows)
