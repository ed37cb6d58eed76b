from __future__ import annotations

import numpy as np
import pytest

from analysis.metrics.samples import embeddings, of_equal_size, resampled_clips
from motion.errors import InputError


@pytest.mark.parametrize("values", [np.zeros(3), np.zeros((3, 0)), np.zeros((2, 3, 4))])
def test_embeddings_are_a_table(values):
    with pytest.raises(InputError, match="shape"):
        embeddings(values)


def test_a_value_that_is_not_finite_is_named_by_its_row():
    values = np.zeros((4, 2))
    values[2, 1] = np.nan
    with pytest.raises(InputError, match="row 2"):
        embeddings(values)


def test_every_row_needs_the_name_of_its_clip():
    with pytest.raises(InputError, match="1 clips are named for 2"):
        embeddings(np.zeros((2, 2)), ["a"])


def test_samples_are_cut_to_the_smaller_one_and_the_same_every_time():
    one, other = embeddings(np.arange(20.0)[:, None]), embeddings(np.zeros((8, 1)))
    cut, kept = of_equal_size(one, other)
    assert (len(cut), len(kept)) == (8, 8)
    assert len(set(cut.values[:, 0])) == 8
    np.testing.assert_array_equal(cut.values, of_equal_size(one, other)[0].values)


def test_windows_of_a_clip_are_drawn_together():
    sample = embeddings(np.zeros((6, 1)), ["a", "b", "a", "c", "b", "a"])
    for rows in resampled_clips(sample, 20, seed=1):
        drawn = np.bincount(rows, minlength=6)
        assert drawn[0] == drawn[2] == drawn[5]
        assert drawn[1] == drawn[4]
        assert drawn[0] + drawn[1] + drawn[3] == 3
