from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from generators.training.batch_order import batches_per_epoch, rows_of_step


@given(st.integers(1, 60), st.integers(1, 20), st.integers(0, 5))
def test_an_epoch_goes_through_all_examples_but_an_unfilled_batch(
    examples: int, size: int, seed: int
) -> None:
    count = batches_per_epoch(examples, size)
    rows = np.concatenate([rows_of_step(step, examples, size, seed) for step in range(count)])
    assert len(set(rows)) == len(rows) == min(examples, count * size)
    assert 0 <= rows.min() <= rows.max() < examples


def test_each_epoch_has_an_order_of_its_own() -> None:
    first, second = (rows_of_step(step, 30, 30, 0) for step in (0, 1))
    assert sorted(first) == sorted(second)
    assert list(first) != list(second)
