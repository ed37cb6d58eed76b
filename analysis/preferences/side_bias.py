"""Whether participants favour a side, whatever it shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.preferences.clustered import ClusteredMean, clustered_mean


@dataclass(frozen=True, kw_only=True)
class SideBias:
    """How often the left video is chosen on one question.

    Attributes
    ----------
    question : str
        Name of the question.
    left_share : ClusteredMean
        Share of answers for the left video, 'no difference' counting one half, tested against .5.
    reference_on_left : float
        Share of these trials that showed the reference on the left; NaN without answers. A side
        bias moves the win share only as far as this differs from .5.
    """

    question: str
    left_share: ClusteredMean
    reference_on_left: float


def side_bias(analysed: pd.DataFrame, questions: Sequence[str]) -> tuple[SideBias, ...]:
    """Estimate the side bias of each question over all comparisons together.

    Parameters
    ----------
    analysed : DataFrame
        Tidy main and repeat answers.
    questions : sequence of str
        Names of the questions in the order wanted.
    """
    found: list[SideBias] = []
    for question in questions:
        answers = analysed[analysed["question"] == question]
        on_left = answers["left_condition"] == answers["reference"]
        found.append(
            SideBias(
                question=question,
                left_share=clustered_mean(
                    (1 - np.sign(answers["value"].to_numpy(np.int64))) / 2,
                    answers["study_session"].to_numpy(str),
                    answers["segment"].to_numpy(str),
                ),
                reference_on_left=float(on_left.mean()) if len(answers) else float("nan"),
            )
        )
    return tuple(found)
