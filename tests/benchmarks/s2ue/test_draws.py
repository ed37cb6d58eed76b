from __future__ import annotations

import numpy as np
import pytest

from benchmarks.s2ue.draws import alike


def test_draws_that_change_both_alike_score_one_and_others_none() -> None:
    chance = np.random.default_rng(1)
    body = chance.normal(size=(12, 40))
    turned = body @ np.linalg.qr(chance.normal(size=(40, 40)))[0]
    other = chance.normal(size=(12, 40))
    assert alike(body, 3 * turned) == pytest.approx(1)
    assert alike(body, other) == pytest.approx(0, abs=0.15)
