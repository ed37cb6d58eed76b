"""A public leaderboard: many systems, a few votes of each visitor, few of each pair."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from analysis.report.sections.answer import answer
from analysis.results.pairwise import PairwiseResults
from tests.analysis.report.subjects import subject_of
from tests.analysis.results.made_tables import THRESHOLDS, report_of

SYSTEMS = 8
PAIRS = SYSTEMS * (SYSTEMS - 1) // 2


def leaderboard(spread: float, *, seed: int, votes: int = 500, each: int = 3) -> pd.DataFrame:
    """Votes on drawn pairs of eight systems whose strengths lie evenly over `spread` logits."""
    chance = np.random.default_rng(seed)
    strengths = np.linspace(spread / 2, -spread / 2, SYSTEMS)
    people, prompts = np.arange(votes) // each, chance.integers(60, size=votes)
    tastes = chance.normal(0, 0.4, (people.max() + 1, SYSTEMS))
    shown = np.array([chance.permutation(SYSTEMS)[:2] for _ in range(votes)])
    worth = strengths[shown] + tastes[people[:, None], shown]
    latent = worth[:, 1] - worth[:, 0] + chance.logistic(size=votes)
    return pd.DataFrame(
        {
            "participant": [f"p{one:03d}" for one in people],
            "segment": [f"s{one:02d}" for one in prompts],
            "question": "quality",
            "trial": np.arange(votes) % each + 1,
            "left": [f"system-{one}" for one in shown[:, 0]],
            "right": [f"system-{one}" for one in shown[:, 1]],
            "response": np.digitize(latent, THRESHOLDS) + 1,
        }
    )


def test_what_single_pairs_do_not_decide_is_decided_by_strengths(tmp_path: Path) -> None:
    results = report_of(leaderboard(1.8, seed=2), "pairwise", tmp_path).results
    assert isinstance(results, PairwiseResults)
    pairs = [comparison.decision.p_holm < 0.05 for comparison in results.comparisons]
    strengths = [contrast.p_holm < 0.05 for contrast in results.contrasts]
    fit = results.bradley_terry.of_set(None)["quality"]
    ranks = {c.condition: (c.best or 0, c.worst or 99) for c in fit.conditions}

    assert results.decided_by == "strengths"
    assert len(pairs) == len(strengths) == PAIRS
    assert sum(pairs) < 3
    assert sum(strengths) > 6
    assert ranks["system-0"][1] < ranks["system-7"][0]
    assert ranks["system-0"][0] == 1


def test_equal_systems_are_left_undecided(tmp_path: Path) -> None:
    found = report_of(leaderboard(0.0, seed=2), "pairwise", tmp_path)

    assert answer(found, subject_of(found))[0].startswith(
        f"None of the {PAIRS} tests is significant"
    )
