from __future__ import annotations

import numpy as np

from analysis.stats.participant_means import group_means


def test_everybody_counts_once_however_many_answers():
    values, people = np.array([1.0, 0, 1, 1]), np.array(["b", "a", "b", "b"])
    assert group_means(values, people).tolist() == [0, 1]
    assert group_means(np.zeros(0), np.zeros(0, str)).tolist() == []
