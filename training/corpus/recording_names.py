"""Names of the corpus' recordings: BEAT's, so that they tell speaker and emotion.

``{number}_{name}_0_{start}_{end}``; start and end are numbers of texts, and each emotion has its
own. No two recordings of a speaker have the same pair.
"""

from __future__ import annotations

from itertools import islice
from types import MappingProxyType
from typing import Final

_TEXTS: Final = MappingProxyType(
    {
        "neutral": (1, 64),
        "happiness": (65, 72),
        "anger": (73, 80),
        "sadness": (81, 86),
        "contempt": (87, 94),
        "surprise": (95, 102),
        "fear": (103, 110),
        "disgust": (111, 118),
    }
)
"""First and last text of each emotion, as in BEAT's English recordings."""


def _pairs(emotion: str) -> list[tuple[int, int]]:
    """Return what start and end can be: single texts first, then ever longer runs of them."""
    first, last = _TEXTS[emotion]
    return [
        (start, start + longer)
        for longer in range(last - first + 1)
        for start in range(first, last + 1 - longer)
    ]


MOST_RECORDINGS: Final = min(len(_pairs(emotion)) for emotion in _TEXTS)
"""Of one speaker in one emotion."""


def recording_name(speaker_number: int, speaker_name: str, emotion: str, index: int) -> str:
    """Return the name of a speaker's recording `index`, from 0, in an emotion.

    Parameters
    ----------
    speaker_number : int
        From 1.
    speaker_name : str
        Letters.
    emotion : str
        One of `motion.segment.EMOTIONS`.
    index : int
        Below `MOST_RECORDINGS`.
    """
    start, end = next(islice(_pairs(emotion), index, None))
    return f"{speaker_number}_{speaker_name}_0_{start}_{end}"
