"""How answers were given: how fast, and how much alike; nobody is excluded by it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.response_times import ResponseTimes, response_times
from analysis.answers.straight_lining import straight_lining

ALIKE: Final = 0.9
"""Share of one answer among all of a participant from which the participant is listed."""


@dataclass(frozen=True, kw_only=True)
class StraightLining:
    """Who gives one answer again and again.

    Attributes
    ----------
    limit : float
        Share of the commonest answer from which a participant is listed.
    participants : mapping of participant to float
        That share of those who are.
    """

    limit: float
    participants: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class Quality:
    """How all participants answered, the excluded ones included."""

    response_seconds: ResponseTimes
    straight_lining: StraightLining


def quality(everyone: pd.DataFrame) -> Quality:
    """Describe how main and repeated trials were answered.

    Parameters
    ----------
    everyone : DataFrame
        Answers, those of excluded participants included.
    """
    people = pd.Categorical(everyone["participant"])
    lines = straight_lining(everyone.assign(value=everyone["value"].round()))
    return Quality(
        response_seconds=response_times(everyone["seconds"].to_numpy(np.float64), people),
        straight_lining=StraightLining(
            limit=ALIKE,
            participants={one.participant: one.share for one in lines if one.share >= ALIKE},
        ),
    )
