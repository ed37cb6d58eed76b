"""Plain studies of any size, for tests of planning."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.planning.part import Kind, Part, Size, Trials, count_analysed


@dataclass(frozen=True, kw_only=True)
class Sketch:
    """A study without a file: everybody judges items along a ring, all equally often.

    Attributes
    ----------
    kind : {'pairs', 'ratings', 'rankings'}
        How conditions are judged.
    conditions : int
        How many every trial shows.
    comparisons : int
        How often the same is done: comparisons of two conditions, or motions with their own and
        another's speech.
    own_participants : bool
        Whether each of them has its own participants.
    questions : int
        Asked of every trial.
    """

    kind: Kind
    conditions: int = 2
    comparisons: int = 1
    own_participants: bool = False
    questions: int = 1

    def size(self, participants: int, items: int, *, excluded: float) -> Size:
        """Return the study with this many participants and items.

        Parameters
        ----------
        excluded : float
            Share of participants who will be left out.
        """
        analysed = count_analysed(participants, excluded)
        who, what = np.divmod(np.arange(analysed * items), items)
        left = (who + what) % 2 if self.kind == "pairs" else None
        part = Part(
            name="",
            kind=self.kind,
            trials=Trials(
                participants=who,
                items=what,
                conditions=self.conditions,
                left=left,
                right=None if left is None else 1 - left,
            ),
            levels=5,
            blocks=self.questions * self.comparisons,
            family="",
        )
        return Size(
            participants=participants,
            items=items,
            recruited=participants * (self.comparisons if self.own_participants else 1),
            analysed=analysed,
            trials=items * (1 if self.own_participants else self.comparisons),
            parts=(part,),
        )
