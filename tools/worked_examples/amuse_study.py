"""What AMUSE prints of its perceptual study (Chhatre et al. 2024)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

RECRUITED: Final = 25
"""Participants of each comparison (section 5.3)."""

PAIRS: Final = 24
"""Pairs whose answers are analysed: three of each of eight emotions, the same for everybody
(section 5.3, appendix H)."""

CATCH_TRIALS: Final = 3
"""Per participant (section 5.3, appendix H)."""


@dataclass(frozen=True, kw_only=True)
class PrintedPreference:
    """One row and criterion of Table A.5.

    Attributes
    ----------
    other : str
        What AMUSE was compared with.
    criterion : str
        The question.
    ours, others : int
        Preferences for AMUSE and for the other, weak or strong, in whole percent of the answers.
    participants : int
        Those analysed (appendix H, and Fig. 6).
    """

    other: str
    criterion: str
    ours: int
    others: int
    participants: int

    @property
    def answers(self) -> int:
        """How many answers the percentages are of."""
        return self.participants * PAIRS

    @property
    def win_share(self) -> float:
        """Of AMUSE, an answer 'equally preferred' counting one half for each side."""
        return (100 + self.ours - self.others) / 200


EMOTION: Final = "emotion"
SYNCHRONISATION: Final = "synchronisation"
GROUND_TRUTH: Final = "GT"

_PARTICIPANTS: Final = {GROUND_TRUTH: 25, "TalkSHOW-BEAT": 22, "TalkSHOW": 20, "Habibie et al.": 23}
_PRINTED: Final = {
    EMOTION: ((38, 51), (46, 39), (54, 34), (48, 42)),
    SYNCHRONISATION: ((35, 52), (62, 27), (65, 28), (66, 28)),
}

TABLE_A5: Final = tuple(
    PrintedPreference(
        other=other,
        criterion=criterion,
        ours=ours,
        others=others,
        participants=_PARTICIPANTS[other],
    )
    for criterion, rows in _PRINTED.items()
    for other, (ours, others) in zip(_PARTICIPANTS, rows, strict=True)
)
"""Table A.5, row by row, first for the emotion and then for synchronisation."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A sentence of the paper that rests on Table A.5.

    Attributes
    ----------
    quote, place : str
        Its words, and where they stand.
    criterion : str
        The question it speaks of.
    others : tuple of str
        What AMUSE is said to differ from.
    amuse_wins : bool
        Whether AMUSE is said to be the better one.
    """

    quote: str
    place: str
    criterion: str
    others: tuple[str, ...]
    amuse_wins: bool

    def rests_on(self, printed: PrintedPreference) -> bool:
        """Tell whether the sentence speaks of this row and criterion."""
        return printed.criterion == self.criterion and printed.other in self.others


_BASELINES: Final = tuple(other for other in _PARTICIPANTS if other != GROUND_TRUTH)
_BETTER: Final = "outperforms all competing methods by a considerable margin on both tasks"
_GAP: Final = "there is still a significant gap between AMUSE and the GT"

CLAIMS: Final = tuple(
    Claim(quote=quote, place="5.3", criterion=criterion, others=others, amuse_wins=wins)
    for quote, others, wins in ((_BETTER, _BASELINES, True), (_GAP, (GROUND_TRUTH,), False))
    for criterion in (EMOTION, SYNCHRONISATION)
)
"""Each of two sentences, once for either question."""
