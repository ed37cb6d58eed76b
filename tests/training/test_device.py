"""Two computations that share torch's threads."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Barrier, get_ident

import pytest
import torch

from training.device import side_by_side, torch_threads


@pytest.fixture(params=[1, 2, 4])
def given(request: pytest.FixtureRequest) -> Iterator[int]:
    with torch_threads(request.param):
        yield request.param


def test_each_has_half_of_the_threads_and_they_are_given_back(given: int) -> None:
    shares = side_by_side(torch.get_num_threads, torch.get_num_threads)
    assert shares == ((1, 1) if given == 1 else (given // 2, given // 2))
    assert torch.get_num_threads() == given


def test_with_one_thread_the_first_is_done_before_the_second_begins() -> None:
    done: list[str] = []
    side_by_side(lambda: done.append("first"), lambda: done.append("second"))
    assert done == ["first", "second"]


def test_with_more_threads_both_run_at_once() -> None:
    both = Barrier(2, timeout=60)

    def met() -> int:
        both.wait()
        return get_ident()

    with torch_threads(2):
        first, second = side_by_side(met, met)
    assert first != second == get_ident()


@pytest.mark.parametrize("fails", [0, 1])
def test_threads_are_given_back_after_a_failure(given: int, fails: int) -> None:
    def failing() -> None:
        raise MemoryError("too large")

    works = [lambda: None, lambda: None]
    works[fails] = failing
    with pytest.raises(MemoryError, match="too large"):
        side_by_side(*works)
    assert torch.get_num_threads() == given


def test_the_other_thread_computes_without_gradients(given: int) -> None:
    weight = torch.ones(1, requires_grad=True)
    with torch.inference_mode():
        first, second = side_by_side(lambda: 2 * weight, lambda: 3 * weight)
    assert not first.requires_grad
    assert not second.requires_grad
