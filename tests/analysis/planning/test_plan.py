import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from analysis.planning.part import Opinions
from analysis.planning.plan import Plan, Request, plan, smallest_effect
from analysis.planning.writing import plan_sentences, write_plan
from tests.analysis.planning.sketch import three_comparisons

REQUEST = Request(
    size=three_comparisons,
    participants=(10, 20, 80),
    items=(6, 12),
    effects=(0.0, 0.5),
    current=(10, 6),
    per_comparison=True,
    opinions=Opinions(),
    source="Assumed",
    excluded=0.1,
    seed=1,
    studies=200,
)


@pytest.fixture(scope="module")
def made() -> Plan:
    return plan(REQUEST)


def test_powers_depend_on_the_seed_alone_and_progress_is_shown(made: Plan) -> None:
    progress: list[tuple[int, int]] = []
    small = replace(REQUEST, participants=(10,), items=(6,))

    again = plan(small, lambda done, total: progress.append((done, total)))

    assert again.power(0, 10, 6, 0.5) == made.power(0, 10, 6, 0.5)
    assert progress == [(1, 2), (2, 2)]
    other = replace(small, seed=2)
    assert other.powers(other.size(10, 6), 0.5) != made.cells[1].powers


def test_sentences_state_power_and_limits(made: Plan) -> None:
    text = "\n".join(plan_sentences(made))

    assert "As it stands, with 10 participants per comparison (9 of them analysed)" in text
    assert "30 participants in all." in text
    assert "The smallest difference that it finds with power .8 is" in text
    assert 0.6 < made.smallest[0].effect < 4
    assert "Assumed: the difference of two conditions varies by 0.6 logits" in text
    assert "If there is no difference" in text
    assert "nan" not in text


def with_powers(made: Plan, powers: dict[tuple[int, int], float]) -> Plan:
    """Return the plan with other powers for its larger effect."""
    cells = tuple(
        replace(
            cell, powers=(replace(cell.powers[0], power=powers[cell.size.numbers], error=0.01),)
        )
        for cell in made.cells
        if cell.powers[0].effect
    )
    return replace(made, cells=cells, request=replace(made.request, effects=(0.5,)))


SATURATED = {
    (10, 6): 0.4,
    (20, 6): 0.55,
    (80, 6): 0.6,
    (10, 12): 0.5,
    (20, 12): 0.75,
    (80, 12): 0.95,
}


ADD_SEGMENTS = (
    "With 6 segments, more than 20 participants per comparison add little: 80 raise the power for "
    "0.5 logits only from .55 to .60; 12 segments raise it to .75: add segments."
)


@pytest.mark.parametrize(
    ("changed", "said", "not_said"),
    [
        ({}, ADD_SEGMENTS, "nan"),
        ({}, "are 80 participants per comparison with 12 segments (.95 ± .01). 240", "nan"),
        ({(20, 12): 0.56}, "add little", "add segments"),
        ({(80, 6): 0.79}, "", "add little"),
    ],
)
def test_segments_are_recommended_if_they_add_more_than_participants(
    changed: dict[tuple[int, int], float], said: str, not_said: str, made: Plan
) -> None:
    text = "\n".join(plan_sentences(with_powers(made, SATURATED | changed)))

    assert said in text
    assert not_said not in text


@pytest.mark.parametrize(
    ("known", "power", "least", "reason"),
    [
        ({0.2: 0.5, 0.4: 0.9}, math.nan, 0.32, ""),
        ({0.2: 0.1}, 0.1, math.nan, "not even a difference"),
        ({0.2: 0.9}, 0.9, math.nan, "even a difference"),
    ],
)
def test_the_smallest_difference_is_interpolated_or_has_a_reason(
    known: dict[float, float], power: float, least: float, reason: str
) -> None:
    effect, why = smallest_effect(known, lambda _: power)

    assert effect == pytest.approx(least, abs=0.03, nan_ok=True)
    assert why.startswith(reason)


def test_two_plans_are_the_same_bytes(made: Plan, tmp_path: Path) -> None:
    first = write_plan(made, tmp_path / "one")
    again = write_plan(plan(REQUEST), tmp_path / "two")

    assert [path.name for path in first] == [*("power.csv", "power.pdf", "power.png", "power.svg")]
    for one, other in zip(first, again, strict=True):
        assert one.read_bytes() == other.read_bytes(), one.name
    assert made.tests == {"": 3}
    powers = pd.read_csv(first[0])
    assert len(powers) == 3 * 2 * 2
    assert {*zip(powers["recruited"], powers["analysed"], strict=True)} == {
        *((30, 9), (60, 18), (240, 72))
    }


def test_a_size_without_a_test_has_a_dash_and_a_reason(tmp_path: Path) -> None:
    alone = replace(REQUEST, participants=(1, 10), items=(1,), current=(10, 1))

    result = plan(alone)
    text = "\n".join(plan_sentences(result))
    write_plan(result, tmp_path / "out")

    powers = pd.read_csv(tmp_path / "out" / "power.csv")
    assert "1 x 1: one participant allows no test" in text
    assert "10 x 1: one segment allows no test" in text
    assert powers["power"].isna().all()
