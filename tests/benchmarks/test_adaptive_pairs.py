import numpy as np

from benchmarks.adaptive_pairs import CHOICES, tournament


def test_adaptive_pairs_find_the_order_first() -> None:
    final: dict[str, list[float]] = {choice: [] for choice in CHOICES}
    for seed in range(100, 125):
        strengths = np.random.default_rng([seed, 1]).normal(0, 2, 6)
        for choice in CHOICES:
            *_, (tau, _) = tournament(strengths, choice=choice, participants=8, seed=seed)
            final[choice].append(tau)

    assert np.mean(final["adaptive"]) > max(np.mean(final["even"]), np.mean(final["random"]))
