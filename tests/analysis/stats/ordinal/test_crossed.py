from __future__ import annotations

import numpy as np
import pytest

from analysis.stats.ordinal.crossed import Information, Layout

SIZES = {"one term": (7,), "two terms": (7, 4), "three terms": (7, 4, 3)}


@pytest.mark.parametrize("sizes", SIZES.values(), ids=SIZES.keys())
def test_it_agrees_with_the_matrix_written_out(sizes: tuple[int, ...]) -> None:
    chance = np.random.default_rng(3)
    groups = tuple(chance.integers(0, size, 60) for size in sizes)
    multipliers = [chance.normal(size=60) for _ in sizes]
    weights = chance.uniform(0.1, 1, 60)
    design = np.concatenate(
        [m[:, None] * np.eye(k)[g] for m, k, g in zip(multipliers, sizes, groups, strict=True)],
        axis=1,
    )
    matrix = np.eye(sum(sizes)) + design.T @ (weights[:, None] * design)
    right = chance.normal(size=sum(sizes))

    layout = Layout(groups, sizes)
    information = Information.of(layout, multipliers, weights)

    np.testing.assert_allclose(information.log_determinant, np.linalg.slogdet(matrix)[1])
    np.testing.assert_allclose(information.solve(right), np.linalg.solve(matrix, right))
    variances = sum(
        m * d for m, d in zip(multipliers, information.directions(multipliers), strict=True)
    )
    expected = np.einsum("ij,jk,ik->i", design, np.linalg.inv(matrix), design)
    np.testing.assert_allclose(variances, expected)
    np.testing.assert_allclose(layout.gather(multipliers), design.sum(axis=0))
    spread = layout.spread(right)
    np.testing.assert_allclose(
        sum(m * s for m, s in zip(multipliers, spread, strict=True)), design @ right
    )
