from __future__ import annotations

import pytest

from studyapp.study.settings.presentation import Page


@pytest.mark.parametrize(
    ("every", "presentations", "breaks"),
    [(10, 24, [10]), (10, 25, [10, 20]), (1, 4, [1, 2]), (0, 100, [])],
)
def test_breaks_come_after_so_many_trials_but_not_shortly_before_the_end(
    every: int, presentations: int, breaks: list[int]
) -> None:
    page = Page(consent="You agree.", break_every=every)

    due = [done for done in range(presentations + 1) if page.break_after(done, presentations)]

    assert due == breaks
