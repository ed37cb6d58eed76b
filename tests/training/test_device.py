"""Two computations that share torch's threads."""

from collections.abc import Iterator
from threading import Barrier, get_ident

import pytest
import torch

from training.device import side_by_side, torch_threads


@pytest.fixture(params=[1, 2, 4])
def given(request: pytest.FixtureRequest) -> Iterator[int]:
    with torch_threads(request.param):
        yield request.param


def test_both_run_at_once_if_there_are_threads() -> None:
    both = Barrier(2, timeout=60)

    def met() -> int:
        both.wait()
        return get_ident()

    with torch_threads(2):
        first, second = side_by_side(met, met)
    assert first != second == get_ident()


def test_each_gets_half_of_the_threads_without_gradients_and_returns_them(given: int) -> None:
    weight = torch.ones(1, requires_grad=True)
    with torch.inference_mode():
        results = side_by_side(
            *(lambda: (torch.get_num_threads(), (2 * weight).requires_grad) for _ in range(2))
        )
    assert results == ((max(1, given // 2), False),) * 2

    def failing() -> None:
        raise MemoryError("too large")

    for works in ((failing, lambda: None), (lambda: None, failing)):
        with pytest.raises(MemoryError, match="too large"):
            side_by_side(*works)
        assert torch.get_num_threads() == given
