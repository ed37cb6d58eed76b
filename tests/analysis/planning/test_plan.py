from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from analysis.planning.grid import Runner, Task, estimate_minutes, limit_effort
from analysis.planning.part import Opinions
from analysis.planning.plan import Plan, Request, plan, smallest_effect
from analysis.planning.power import Effort
from analysis.planning.words import plan_sentences
from analysis.planning.writing import write_plan
from tests.analysis.planning.sketch import Sketch

SKETCH = Sketch(kind="pairs", comparisons=3, own_participants=True)
REQUEST = Request(
    title="A study",
    protocol="pairwise",
    size=lambda participants, items: SKETCH.size(participants, items, excluded=0.1),
    participants=(10, 20, 80),
    items=(6, 12),
    effects=(0.0, 0.5),
    own=(10, 6),
    per_comparison=True,
    opinions=Opinions(),
    source="Assumed",
    excluded=0.1,
    pay=2.5,
    effort=Effort(quick=200, exact=40),
    minutes=2.0,
    seed=1,
)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    return plan(REQUEST, Runner(folder=tmp_path_factory.mktemp("cells")))


def task(effect: float = 0.5, seed: int = 1) -> Task:
    return Task(
        size=REQUEST.size(8, 6),
        effect=effect,
        opinions=Opinions(),
        effort=Effort(quick=100),
        seed=seed,
    )


def test_what_was_simulated_is_not_simulated_again(tmp_path: Path) -> None:
    (first,) = Runner(folder=tmp_path).cells([task()])
    kept = next(tmp_path.iterdir())
    rows = json.loads(kept.read_text("utf-8"))
    rows[0]["power"] = 0.123
    kept.write_text(json.dumps(rows), "utf-8")

    (again,) = Runner(folder=tmp_path).cells([task()])

    assert again.powers[0].power == 0.123
    kept.write_text("{broken", "utf-8")
    (fresh,) = Runner(folder=tmp_path).cells([task()])
    assert fresh.powers == first.powers


def test_another_seed_effect_or_design_is_another_cell() -> None:
    keys = {
        task().key,
        task(seed=2).key,
        task(effect=0.4).key,
        replace(task(), size=REQUEST.size(9, 6)).key,
        replace(task(), opinions=Opinions(item_sd=0.2)).key,
    }

    assert len(keys) == 5
    assert task().key == task().key


def test_progress_is_told_cell_by_cell(tmp_path: Path) -> None:
    progress: list[tuple[int, int]] = []
    runner = Runner(folder=tmp_path, show=lambda done, total: progress.append((done, total)))

    runner.cells([task(), task(effect=0.2)])

    assert progress == [(0, 2), (1, 2), (2, 2)]


def test_less_is_simulated_where_it_would_take_too_long() -> None:
    tasks = [replace(task(), effort=Effort())] * 10

    assert limit_effort(tasks, estimate_minutes(tasks) * 1.01) == tasks
    less = limit_effort(tasks, estimate_minutes(tasks) / 2)
    assert less[0].effort.quick == 1000
    assert estimate_minutes(less) < estimate_minutes(tasks)


def test_a_plan_that_was_cut_says_so(tmp_path: Path) -> None:
    short = replace(REQUEST, minutes=1e-6, effort=Effort(quick=500))

    result = plan(short, Runner(folder=tmp_path))

    assert "400 simulated studies instead of 500" in result.cut
    assert plan_sentences(result)[-1] == result.cut


def test_a_plan_holds_every_size_and_effect(made: Plan) -> None:
    assert len(made.cells) == 3 * 2 * 2
    assert {cell.size.recruited for cell in made.cells} == {30, 60, 240}
    assert {cell.size.analysed for cell in made.cells} == {9, 18, 72}
    assert made.tests == {"": 3}


def test_sentences_say_what_a_researcher_must_know(made: Plan) -> None:
    text = "\n".join(plan_sentences(made))

    assert "As it stands, with 10 participants per comparison (9 of them analysed)" in text
    assert "30 participants in all cost 75.00." in text
    assert "The smallest difference that it finds with power .8 is" in text
    assert "Assumed: the difference of two conditions varies by 0.6 logits" in text
    assert "Where there is no difference" in text
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


def test_where_participants_add_little_segments_are_recommended(made: Plan) -> None:
    text = "\n".join(plan_sentences(with_powers(made, SATURATED)))

    assert (
        "With 6 segments, more than 20 participants per comparison add little: 80 raise the power "
        "for 0.5 logits from .55 to .60 only; 12 segments raise it to .75: add segments."
    ) in text
    assert "are 80 participants per comparison with 12 segments (.95 ± .01). 240" in text


def test_segments_are_not_recommended_where_they_add_no_more(made: Plan) -> None:
    text = "\n".join(plan_sentences(with_powers(made, {**SATURATED, (20, 12): 0.56})))

    assert "add little" in text
    assert "add segments" not in text


def test_where_participants_still_help_nothing_is_called_little(made: Plan) -> None:
    rising = {**SATURATED, (80, 6): 0.79}

    assert "add little" not in "\n".join(plan_sentences(with_powers(made, rising)))


def test_the_smallest_difference_lies_where_the_power_is_reached(made: Plan) -> None:
    (one,) = made.smallest
    own = made.cell(10, 6, 0.5)
    assert own is not None

    assert own.powers[0].power < 0.8
    assert 0.6 < one.effect < 4
    assert "wins" in one.in_answers


def test_between_two_powers_the_smallest_difference_is_interpolated() -> None:
    def never(_: float) -> float:
        raise AssertionError

    effect, reason = smallest_effect({0.2: 0.5, 0.4: 0.9}, never)

    assert 0.2 < effect < 0.4
    assert not reason


def test_a_difference_that_is_never_found_has_a_reason() -> None:
    effect, reason = smallest_effect({0.2: 0.1}, lambda _: 0.1)

    assert math.isnan(effect)
    assert "not even" in reason
    effect, reason = smallest_effect({0.2: 0.9}, lambda _: 0.9)
    assert math.isnan(effect)
    assert "even a difference" in reason


def test_two_plans_are_the_same_bytes(made: Plan, tmp_path: Path) -> None:
    first = write_plan(made, tmp_path / "one")
    again = write_plan(plan(REQUEST, Runner(folder=tmp_path / "cells")), tmp_path / "two")

    assert [path.name for path in first] == [
        *("plan.json", "power.csv", "power.pdf", "power.png", "power.svg")
    ]
    for one, other in zip(first, again, strict=True):
        assert one.read_bytes() == other.read_bytes(), one.name
    result = json.loads(first[0].read_text("utf-8"))
    assert result["as_it_stands"] == {"participants": 10, "segments": 6}
    assert len(result["powers"]) == len(made.cells)


def test_a_size_without_a_test_has_a_dash_and_a_reason(tmp_path: Path) -> None:
    alone = replace(REQUEST, participants=(1, 10), items=(1,), own=(10, 1))

    result = plan(alone, Runner(folder=tmp_path))
    text = "\n".join(plan_sentences(result))
    write_plan(result, tmp_path / "out")

    powers = json.loads((tmp_path / "out" / "plan.json").read_text("utf-8"))["powers"]

    assert "1 x 1: one participant allows no test" in text
    assert "10 x 1: one segment allows no test" in text
    assert {row["power"] for row in powers} == {None}
