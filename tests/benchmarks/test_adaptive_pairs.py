from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from benchmarks.adaptive_pairs import (
    CHOICES,
    KNOWN,
    TRIALS,
    answers_needed,
    draw,
    report,
    simulate,
    tournament,
)


def test_the_figure_is_drawn_and_its_numbers_are_printed(tmp_path: Path) -> None:
    curves = {1.0: simulate(strength_sd=1.0, repetitions=2, participants=5, conditions=4)}

    draw(curves, tmp_path / "adaptive.png")

    with Image.open(tmp_path / "adaptive.png") as picture:
        assert picture.width > 600
    printed = report(curves)
    for choice in CHOICES:
        assert curves[1.0][choice].shape == (2, 5, 2)
        assert f"{curves[1.0][choice][:, 4, 0].mean():.3f}" in printed
        assert f"answers_until_known_{choice}_sd_1: " in printed


def test_an_order_is_known_from_the_first_participant_who_completes_it() -> None:
    taus = np.array([[0.5, KNOWN, 0.8], [0.7, KNOWN, 1.0]])
    curve = np.stack([taus, np.zeros_like(taus)], axis=-1)

    assert answers_needed(curve) == 2 * TRIALS
    assert answers_needed(curve[:, :1]) is None


def test_adaptive_pairs_find_the_order_first() -> None:
    final: dict[str, list[float]] = {choice: [] for choice in CHOICES}
    for seed in range(100, 125):
        strengths = np.random.default_rng([seed, 1]).normal(0, 2, 6)
        for choice in CHOICES:
            *_, (tau, _) = tournament(strengths, choice=choice, participants=8, seed=seed)
            final[choice].append(tau)

    assert np.mean(final["adaptive"]) > max(np.mean(final["even"]), np.mean(final["random"]))
