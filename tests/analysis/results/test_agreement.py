from __future__ import annotations

import numpy as np
import pandas as pd

from analysis.results.agreement import retest_of


def test_practice_trials_meet_their_own_repeats() -> None:
    rows = [
        ("p1", "practice", "s1", 0, 2),
        ("p1", "practice", "s1", 0, 1),
        ("p1", "practice", "s2", 0, 2),
        ("p1", "main", "s3", 0, 0),
        ("p1", "repeat", "s2", 0, -2),
        ("p1", "repeat", "s1", 0, 1),
        ("p1", "repeat", "s1", 0, -1),
        ("p2", "practice", "s1", 0, 0),
        ("p2", "repeat", "s1", 1, 0),
    ]
    answers = pd.DataFrame(rows, columns=["participant", "kind", "segment", "shown", "value"])
    named = answers.astype({"participant": "category", "segment": "category"})

    found = retest_of(named, answers["value"].to_numpy(), {"shown": np.array(answers["shown"])})

    assert (found.n, found.participants, found.equal_share) == (2, 1, 0.5)
