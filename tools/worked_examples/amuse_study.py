"""The published numbers of AMUSE's perceptual study (Chhatre et al. 2024)."""

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
        The condition compared with AMUSE.
    criterion : str
        The question.
    ours, others : int
        Weak or strong preferences for AMUSE and for the other, in whole percent of the answers.
    participants : int
        Number of analysed participants (appendix H, and Fig. 6).
    """

    other: str
    criterion: str
    ours: int
    others: int
    participants: int

    @property
    def answers(self) -> int:
        """Number of answers that the percentages refer to."""
        return self.participants * PAIRS

    @property
    def win_share(self) -> float:
        """AMUSE's win share; an answer 'equally preferred' counts one half for each side."""
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
"""Table A.5 by row, first for emotion and then for synchronisation."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A sentence of the paper that rests on Table A.5.

    Attributes
    ----------
    quote, place : str
        The sentence and its place in the paper.
    criterion : str
        The question that it is about.
    others : tuple of str
        Conditions from which AMUSE is claimed to differ.
    amuse_wins : bool
        Whether AMUSE is claimed to be better.
    """

    quote: str
    place: str
    criterion: str
    others: tuple[str, ...]
    amuse_wins: bool

    def rests_on(self, printed: PrintedPreference) -> bool:
        """Return whether the sentence is about this row and criterion."""
        return printed.criterion == self.criterion and printed.other in self.others


_BASELINES: Final = tuple(other for other in _PARTICIPANTS if other != GROUND_TRUTH)
_BETTER: Final = "outperforms all competing methods by a considerable margin on both tasks"
_GAP: Final = "there is still a significant gap between AMUSE and the GT"

CLAIMS: Final = tuple(
    Claim(quote=quote, place="5.3", criterion=criterion, others=others, amuse_wins=wins)
    for quote, others, wins in ((_BETTER, _BASELINES, True), (_GAP, (GROUND_TRUTH,), False))
    for criterion in (EMOTION, SYNCHRONISATION)
)
"""Two sentences, each once per question."""
