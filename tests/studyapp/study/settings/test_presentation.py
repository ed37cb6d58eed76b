from __future__ import annotations

from typing import Any

import pytest

from studyapp.study.settings.presentation import Page


def page(**keys: Any) -> Page:
    return Page.model_validate({"consent": "You agree."} | keys)


@pytest.mark.parametrize(
    ("every", "presentations", "breaks"),
    [
        (10, 30, [10, 20]),
        (10, 24, [10]),
        (10, 25, [10, 20]),
        (1, 4, [1, 2]),
        (4, 16, [4, 8, 12]),
        (0, 100, []),
        (50, 40, []),
    ],
)
def test_breaks_come_after_so_many_trials_but_not_shortly_before_the_end(
    every: int, presentations: int, breaks: list[int]
) -> None:
    asked = page(break_every=every)

    due = [done for done in range(presentations + 1) if asked.break_after(done, presentations)]

    assert due == breaks
