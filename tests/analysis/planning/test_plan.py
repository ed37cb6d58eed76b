from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from analysis.planning.grid import Runner, Task, estimate_minutes, limit_effort
from analysis.planning.part import Opinions
from analysis.planning.plan import Plan, Request, plan, smallest_effect
from analysis.planning.power import Effort
from analysis.planning.writing import plan_sentences, write_plan
from tests.analysis.planning.sketch import Sketch

SKETCH = Sketch(kind="pairs", comparisons=3, own_participants=True)
REQUEST = Request(
    size=lambda participants, items: SKETCH.size(participants, items, excluded=0.1),
    participants=(10, 20, 80),
    items=(6, 12),
    effects=(0.0, 0.5),
    current=(10, 6),
    per_comparison=True,
    opinions=Opinions(),
    source="Assumed",
    excluded=0.1,
    effort=Effort(quick=200, exact=40),
    minutes=2.0,
    seed=1,
)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    return plan(REQUEST, Runner(folder=tmp_path_factory.mktemp("cells")))


TASK = Task(
    size=REQUEST.size(8, 6), effect=0.5, opinions=Opinions(), effort=Effort(quick=100), seed=1
)


def test_finished_simulations_are_reused_and_progress_is_shown(tmp_path: Path) -> None:
    progress: list[tuple[int, int]] = []
    runner = Runner(folder=tmp_path, show=lambda done, total: progress.append((done, total)))
    (first,) = runner.cells([TASK])
    kept = next(tmp_path.iterdir())
    rows = json.loads(kept.read_text("utf-8"))
    rows[0]["power"] = 0.123
    kept.write_text(json.dumps(rows), "utf-8")

    again, _ = runner.cells([TASK, replace(TASK, effect=0.2)])

    assert again.powers[0].power == 0.123
    assert progress == [(0, 1), (1, 1), (1, 2), (2, 2)]
    kept.write_text("{broken", "utf-8")
    (fresh,) = runner.cells([TASK])
    assert fresh.powers == first.powers


def test_cells_depend_on_seed_effect_and_design() -> None:
    others = (
        replace(TASK, seed=2),
        replace(TASK, effect=0.4),
        replace(TASK, size=REQUEST.size(9, 6)),
        replace(TASK, opinions=Opinions(item_sd=0.2)),
    )

    assert len({TASK.key, *(other.key for other in others)}) == 5
    assert replace(TASK, size=REQUEST.size(8, 6)).key == TASK.key


def test_fewer_studies_are_simulated_if_they_would_take_too_long() -> None:
    tasks = [replace(TASK, effort=Effort())] * 10

    assert limit_effort(tasks, estimate_minutes(tasks) * 1.01) == tasks
    less = limit_effort(tasks, estimate_minutes(tasks) / 2)
    assert less[0].effort.quick == 1000
    assert estimate_minutes(less) < estimate_minutes(tasks)


def test_a_shortened_plan_says_so(tmp_path: Path) -> None:
    short = replace(REQUEST, minutes=1e-6, effort=Effort(quick=500))

    result = plan(short, Runner(folder=tmp_path))

    assert "400 simulated studies instead of 500" in result.cut
    assert plan_sentences(result)[-1] == result.cut


def test_sentences_state_power_and_limits(made: Plan) -> None:
    text = "\n".join(plan_sentences(made))

    assert "As it stands, with 10 participants per comparison (9 of them analysed)" in text
    assert "30 participants in all." in text
    assert "The smallest difference that it finds with power .8 is" in text
    assert "Assumed: the difference of two conditions varies by 0.6 logits" in text
    assert "If there is no difference" in text
    assert "nan" not in text


def with_powers(made: Plan, powers: dict[tuple[int, int], float]) -> Plan:
    """Return the plan with other powers for its larger effect."""
    cells = tuple(
        replace(
            cell,
            powers=tuple(
                replace(power, power=powers[cell.size.numbers], error=0.01) for power in cell.powers
            ),
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


def test_the_smallest_difference_is_where_the_power_is_reached(made: Plan) -> None:
    (one,) = made.smallest

    assert made.power(0, 10, 6, 0.5).power < 0.8
    assert 0.6 < one.effect < 4
    assert "wins" in one.in_answers


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
    again = write_plan(plan(REQUEST, Runner(folder=tmp_path / "cells")), tmp_path / "two")

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

    result = plan(alone, Runner(folder=tmp_path))
    text = "\n".join(plan_sentences(result))
    write_plan(result, tmp_path / "out")

    powers = pd.read_csv(tmp_path / "out" / "power.csv")
    assert "1 x 1: one participant allows no test" in text
    assert "10 x 1: one segment allows no test" in text
    assert powers["power"].isna().all()
