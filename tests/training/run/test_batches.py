from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from training.run.batches import (
    batches_per_epoch,
    parts_of_step,
    rows_of_step,
)


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


@given(st.integers(1, 60), st.integers(1, 9), st.integers(1, 4))
def test_parts_hold_each_example_once_and_are_shared_evenly(
    examples: int, accumulate: int, processes: int
) -> None:
    rows = np.arange(max(examples, processes))
    parts = parts_of_step(rows, accumulate, processes)
    assert np.array_equal(np.concatenate(parts), rows)
    assert len(parts) % processes == 0
    assert {len(part) for part in parts} <= {len(rows) // len(parts), -(-len(rows) // len(parts))}
    assert min(len(part) for part in parts) > 0
    if len(rows) >= accumulate + processes:
        assert accumulate <= len(parts) < accumulate + processes
