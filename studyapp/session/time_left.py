"""How long the rest of the trials will take, as honestly as can be said."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median
from typing import Final

SECONDS_FOR_A_PAGE: Final = 8.0
SECONDS_FOR_EACH_VIDEO: Final = 7.0
SECONDS_FOR_EACH_ANSWER: Final = 4.0
"""What reading and answering takes beside the videos, before the participant's pace is known.

Whichever takes longer counts, the videos or, as in ratings and rankings, the many answers.
"""


def expected_seconds(durations: Sequence[float], answers: int) -> float:
    """Return what a trial takes most people.

    Parameters
    ----------
    durations : sequence of float
        Of its videos, in seconds.
    answers : int
        How many it asks for.
    """
    answering = max(SECONDS_FOR_EACH_VIDEO * len(durations), SECONDS_FOR_EACH_ANSWER * answers)
    return SECONDS_FOR_A_PAGE + answering + sum(durations)


def minutes_left(answered: Sequence[tuple[float, float]], remaining: Sequence[float]) -> int:
    """Return the minutes that the remaining trials take at the participant's own pace.

    Breaks are between trials and do not count. One long interruption does not, either: the
    median of the participant's paces decides.

    Parameters
    ----------
    answered : sequence of (float, float)
        Seconds that each answered trial took, and that it was expected to take.
    remaining : sequence of float
        Expected seconds of each trial to come, the present one included.

    Returns
    -------
    int
        At least 1.
    """
    pace = median(took / expected for took, expected in answered) if answered else 1.0
    return max(1, math.ceil(pace * sum(remaining) / 60))
