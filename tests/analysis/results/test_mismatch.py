from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.results.headline import retest_of
from analysis.results.pairwise import MismatchResults
from tests.analysis.results.made_tables import mismatch_table, report_of


def test_raters_prefer_own_speech_if_the_motion_shows_it(tmp_path: Path) -> None:
    table = mismatch_table()
    result = report_of(table, "mismatch", tmp_path).results
    assert isinstance(result, MismatchResults)

    truth, static = result.conditions
    own = table[table["condition"] == "truth"]
    towards = np.where(own["right_speech"] == "own", 1, -1) * (own["response"] - 3)
    assert truth.counts["own_strong"] == (towards == 2).sum()
    assert truth.win_share.estimate == pytest.approx(((np.sign(towards) + 1) / 2).mean())
    assert truth.clmm.estimate > static.clmm.estimate
    assert truth.decision.p_holm == pytest.approx(min(1, 2 * truth.decision.p_value))
    assert set(truth.share) == {"own", "other", "equal"}
    bias = result.side_bias.of_set(None)["fits"]
    assert bias.on_left == pytest.approx((table["left_speech"] == "own").mean())


def test_practice_trials_are_paired_with_their_own_repeats() -> None:
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
    answers = pd.DataFrame(rows, columns=["participant", "kind", "segment", "condition", "value"])
    named = answers.astype(dict.fromkeys(("participant", "segment", "condition"), "category"))

    result = retest_of(named)

    assert (result.n, result.participants, result.equal_share) == (2, 1, 0.5)
