"""Rankings with known worths, as a table."""

from __future__ import annotations

import numpy as np
import pandas as pd

CONDITIONS = ("ours", "second", "third", "last")


def made_rankings(
    *,
    participants: int = 22,
    segments: int = 8,
    worths: tuple[float, ...] = (1.0, 0.5, 0.0, -0.5),
    spread: float = 0.4,
    seed: int = 1,
) -> pd.DataFrame:
    """Return the ranks that every participant gives in every segment."""
    generator = np.random.default_rng(seed)
    size = (participants, segments, len(worths))
    latent = (
        np.array(worths)
        + generator.normal(0, spread, (participants, 1, len(worths)))
        + generator.normal(0, spread, (1, segments, len(worths)))
        + generator.gumbel(size=size)
    )
    ranks = (-latent).argsort(axis=2).argsort(axis=2) + 1
    who, what, which = (index.ravel() for index in np.indices(size))
    return pd.DataFrame(
        {
            "participant": [f"p{k:02d}" for k in who],
            "segment": [f"s{k}" for k in what],
            "condition": np.array(CONDITIONS[: len(worths)])[which],
            "rank": ranks.ravel(),
        }
    )


def ranking(*rows: dict[str, int]) -> pd.DataFrame:
    """Return one ranking per participant, all of one segment."""
    return pd.DataFrame(
        [
            {"participant": f"p{number}", "segment": "s", "condition": name, "rank": rank}
            for number, row in enumerate(rows)
            for name, rank in row.items()
        ]
    )
