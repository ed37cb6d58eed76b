"""Ordered answers with a known truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.stats.ordinal.mixed_model import RandomEffect
from motion.arrays import Floats, Indices

THRESHOLDS = (-1.6, -0.45, 0.45, 1.6)


@dataclass(frozen=True)
class MadeAnswers:
    values: Indices
    side: Floats
    participants: Indices
    items: Indices

    @property
    def slopes(self) -> tuple[RandomEffect, RandomEffect]:
        """Return participants and items that differ in their preference."""
        return (
            RandomEffect(name="participant", groups=self.participants, multiplier=self.side),
            RandomEffect(name="item", groups=self.items, multiplier=self.side),
        )


def made_answers(
    participants: int = 20,
    items: int = 12,
    *,
    effect: float = 0.4,
    sd_participant: float = 0.6,
    sd_item: float = 0.45,
    seed: int = 1,
) -> MadeAnswers:
    chance = np.random.default_rng(seed)
    who, what = np.divmod(np.arange(participants * items), items)
    side = chance.choice([-1.0, 1.0], len(who))
    taste = effect + chance.normal(0, sd_participant, participants)[who]
    taste += chance.normal(0, sd_item, items)[what]
    latent = side * taste + chance.logistic(size=len(who))
    return MadeAnswers(np.digitize(latent, THRESHOLDS), side, who, what)
