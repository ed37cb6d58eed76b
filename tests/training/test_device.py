"""Two computations that share torch's threads."""

from threading import Barrier, get_ident

import pytest
import torch

from training.device import side_by_side, torch_threads


def test_both_run_at_once_if_there_are_threads() -> None:
    both = Barrier(2, timeout=60)

    def met() -> int:
        both.wait()
        return get_ident()

    with torch_threads(2):
        first, second = side_by_side(met, met)
    assert first != second == get_ident()


@pytest.mark.parametrize("given", [1, 2, 4])
def test_each_gets_half_of_the_threads_without_gradients_and_returns_them(given: int) -> None:
    weight = torch.ones(1, requires_grad=True)

    def work() -> tuple[int, bool]:
        return torch.get_num_threads(), (2 * weight).requires_grad

    def failing() -> None:
        raise MemoryError("too large")

    with torch_threads(given), torch.inference_mode():
        assert side_by_side(work, work) == ((max(1, given // 2), False),) * 2
        for works in ((failing, lambda: None), (lambda: None, failing)):
            with pytest.raises(MemoryError, match="too large"):
                side_by_side(*works)
            assert torch.get_num_threads() == given
