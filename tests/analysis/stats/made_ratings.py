"""Ratings with known differences, as a table."""

from __future__ import annotations

import numpy as np
import pandas as pd

CONDITIONS = ("ours", "other", "static")


def made_ratings(
    *, participants: int = 20, segments: int = 8, effects=(0.0, -0.5, -1.2), seed: int = 1
) -> pd.DataFrame:
    """Return ratings 1 to 5 of every condition by every participant in every segment."""
    generator = np.random.default_rng(seed)
    who, what, which = (
        index.ravel() for index in np.indices((participants, segments, len(effects)))
    )
    latent = (
        np.asarray(effects)[which]
        + generator.normal(0, 1, participants)[who]
        + generator.normal(0, 0.4, segments)[what]
        + generator.logistic(size=len(who))
    )
    return pd.DataFrame(
        {
            "participant": [f"p{k:02d}" for k in who],
            "segment": [f"s{k}" for k in what],
            "condition": np.array(CONDITIONS)[which],
            "value": np.digitize(latent, [-2.5, -1.0, 0.4, 2.0]) + 1,
        }
    )
