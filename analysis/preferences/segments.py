"""How the reference fares in each single segment: description, never a test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.preferences.counts import towards_reference


@dataclass(frozen=True, kw_only=True)
class SegmentShare:
    """Win share of the reference in one segment, for one comparison and question.

    Attributes
    ----------
    comparison, question, segment, emotion : str
        What it is about.
    answers : int
        How many answers it rests on, one per participant.
    win_share : float
        Share of answers for the reference, 'no difference' counting one half.
    """

    comparison: str
    question: str
    segment: str
    emotion: str
    answers: int
    win_share: float


def segment_shares(analysed: pd.DataFrame) -> tuple[SegmentShare, ...]:
    """Return the win share of every segment that was answered about, ordered by name.

    Parameters
    ----------
    analysed : DataFrame
        Tidy main and repeat answers.
    """
    scored = analysed.assign(win=(np.sign(towards_reference(analysed)) + 1) / 2)
    shares = scored.groupby(["comparison", "question", "segment", "emotion"])["win"]
    table = shares.agg(["size", "mean"]).reset_index()
    return tuple(
        SegmentShare(
            comparison=str(comparison),
            question=str(question),
            segment=str(segment),
            emotion=str(emotion),
            answers=int(answers),
            win_share=float(share),
        )
        for comparison, question, segment, emotion, answers, share in table.itertuples(index=False)
    )
