"""What the corpus' speakers say: passages of two sentences that fit an emotion.

A passage is an opening and a closing of the same emotion, each a sentence of its own. The last
three of each are kept for passages that no training ever hears.
"""

from __future__ import annotations

from typing import Final

from training.corpus.sentences import CLOSINGS, OPENINGS

UNHEARD: Final = 3
"""Openings, and closings, of each emotion that only passages for testing are made of."""


def passage(emotion: str, number: int, *, unheard: bool = False) -> str:
    """Return a passage of two sentences.

    Parameters
    ----------
    emotion : str
        One of `motion.segment.EMOTIONS`.
    number : int
        Which one, from 0. Passages repeat when openings have met all closings: after 81, or 9
        where `unheard`. The first 9, or 3, share no sentence.
    unheard : bool
        Whether it is made of the sentences that are kept for testing.

    Returns
    -------
    str
        Twenty words or so, spoken in six to nine seconds.
    """
    openings, closings = (_part(sentences[emotion], unheard) for sentences in (OPENINGS, CLOSINGS))
    count = len(openings)
    first, shift = number % count, number // count % count
    return f"{openings[first]} {closings[(first + shift) % count]}"


def _part(sentences: tuple[str, ...], unheard: bool) -> tuple[str, ...]:
    return sentences[-UNHEARD:] if unheard else sentences[:-UNHEARD]
