"""Between a network's values and the motion's."""

from __future__ import annotations

import numpy as np
import pytest

from training.spaces.normalisation import Normalisation


def test_what_is_normalised_is_restored() -> None:
    rng = np.random.default_rng(1)
    motion = rng.normal(3, 2, (50, 4))
    known = Normalisation(motion.mean(axis=0), motion.std(axis=0))
    normalised = known.normalised(motion)
    assert normalised.mean(axis=0) == pytest.approx(0, abs=1e-9)
    assert normalised.std(axis=0) == pytest.approx(1)
    np.testing.assert_allclose(known.restored(normalised), motion)
