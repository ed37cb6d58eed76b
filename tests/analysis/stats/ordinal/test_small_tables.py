from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from analysis.stats.ordinal.mixed_model import OrdinalFit, RandomEffect, fit
from tests.analysis.results.made_tables import pairwise_table
from tests.analysis.stats.ordinal.made_answers import MadeAnswers, made_answers


def fitted(made: MadeAnswers, *, mirrored: bool = False) -> OrdinalFit:
    values, side = (4 - made.values, -made.side) if mirrored else (made.values, made.side)
    slopes = [
        RandomEffect(name=e.name, groups=e.groups, multiplier=-e.multiplier if mirrored else side)  # type: ignore[operator]
        for e in made.slopes
    ]
    return fit(values, {"side": side}, slopes)


@st.composite
def small_studies(draw: st.DrawFn) -> MadeAnswers:
    spread = st.sampled_from([0.0, 0.5, 1.5])
    made = made_answers(
        draw(st.integers(2, 7)),
        draw(st.integers(2, 7)),
        effect=draw(st.floats(-2, 2)),
        sd_participant=draw(spread),
        sd_item=draw(spread),
        seed=draw(st.integers(0, 2**20)),
    )
    assume(np.ptp(made.values) and np.ptp(made.side))
    return made


@settings(max_examples=12, deadline=None)
@given(small_studies())
def test_a_fit_converges_or_says_what_parts_the_answers_and_so_does_its_mirror_image(
    made: MadeAnswers,
) -> None:
    one, other = fitted(made), fitted(made, mirrored=True)

    for found in (one, other):
        assert found.converged or "separated" in found.remark or "Hardly any" in found.remark
        assert not found.converged or found.standard_errors["side"] > 0
    if one.converged and other.converged:
        assert other.log_likelihood == pytest.approx(one.log_likelihood, abs=0.01)


def test_a_climb_that_ends_too_early_goes_on() -> None:
    table = pairwise_table(("x", "y"), effects=(1.0, 0.0), participants=4, segments=4)
    table = table[table["kind"] != "practice"]
    side = np.where(table["right"] == "x", 1.0, -1.0)
    random = [
        RandomEffect(name=name, groups=table[name].to_numpy(str), multiplier=side)
        for name in ("participant", "segment")
    ]

    found = fit(table["response"].to_numpy(int), {"side": side}, random)
    mirrored = fit(6 - table["response"].to_numpy(int), {"side": side}, random)

    assert found.converged
    assert mirrored.estimates["side"] == pytest.approx(-found.estimates["side"], abs=1e-3)


def test_a_deviation_does_not_stay_at_zero_where_the_answers_say_otherwise() -> None:
    """The climb from the usual start ends with participants alike, although they differ."""
    chance = np.random.default_rng(129)
    people, items = (int(chance.integers(2, 8)) for _ in range(2))
    effect = chance.normal(0, 1)
    taste = chance.normal(0, chance.choice([0, 0.5, 1.5]), people)
    luck = chance.normal(0, chance.choice([0, 0.5, 1.5]), items)
    who, what = np.repeat(np.arange(people), items), np.tile(np.arange(items), people)
    side = chance.choice([-1.0, 1.0], people * items)
    latent = side * (effect + taste[who] + luck[what]) + chance.logistic(size=people * items)
    values = np.digitize(latent, (-1.6, -0.45, 0.45, 1.6))

    found = fitted(MadeAnswers(values, side, who, what))

    assert fitted(MadeAnswers(values, side, who, what), mirrored=True).log_likelihood == (
        pytest.approx(found.log_likelihood, abs=1e-4)
    )
    assert found.deviations["participant"] > 0.1
