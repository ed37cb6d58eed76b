"""The processes that train one network together, and their communication.

torchrun or ``accelerate launch`` starts them with the same command; see `training.run.launching`. A
single process is a group of one.
"""

import atexit
from collections.abc import Iterable, Mapping
from datetime import timedelta
from importlib import import_module
from typing import Any, Final, TypeVar

import torch
from accelerate import PartialState
from accelerate.utils import broadcast, broadcast_object_list, reduce
from torch import Tensor, nn
from torch.distributed import all_reduce

from motion.errors import InputError
from training.run.launching import group_size

_PATIENCE: Final = timedelta(hours=2)
"""Longest wait for another process: the leader validates and saves while the others wait."""

_Value = TypeVar("_Value")


class Group:
    """The processes of a training.

    Parameters
    ----------
    device : str
        ``cpu`` or ``cuda``; with ``cuda``, each process gets its own GPU.

    Raises
    ------
    InputError
        If a machine has fewer GPUs than processes.
    """

    def __init__(self, device: str) -> None:
        if group_size() == 1:
            self._state = PartialState(cpu=device == "cpu")
            return
        # If torch's optimizers imported it later, its functions would keep this group as a default
        # after its end, and the group's threads could abort the process at exit.
        import_module("torch.distributed.nn.functional")
        self._state = PartialState(cpu=device == "cpu", timeout=_PATIENCE)
        # NCCL complains about a process that exits without destroying its group.
        atexit.register(self._state.destroy_process_group)
        if self.size != group_size():
            raise InputError(
                f"{group_size()} processes were started, but only {self.size} found each other",
                remedy="Start them with torchrun or 'accelerate launch'",
            )
        if device == "cuda" and self._state.local_process_index >= torch.cuda.device_count():
            raise InputError(
                f"at least {self._state.local_process_index + 1} processes were started on a "
                f"machine with {torch.cuda.device_count()} GPUs",
                remedy="Start one process for each GPU of a machine",
            )

    @property
    def size(self) -> int:
        """The number of processes."""
        return int(self._state.num_processes)

    @property
    def index(self) -> int:
        """The index of this process, from 0."""
        return int(self._state.process_index)

    @property
    def leads(self) -> bool:
        """Whether this is the process that validates and writes."""
        return self.index == 0

    def any(self, value: bool) -> bool:
        """Return whether `value` is true in any process."""
        return value if self.size == 1 else self.sum({"": float(value)})[""] > 0

    def sum(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return each value's sum over all processes, in the same order."""
        if self.size == 1:
            return dict(values)
        packed = torch.tensor(list(values.values()), dtype=torch.float64, device=self._state.device)
        return dict(zip(values, reduce(packed, reduction="sum").tolist(), strict=True))

    def from_leader(self, value: _Value) -> _Value:
        """Return the leading process' `value`; the other processes' values are ignored."""
        if self.size == 1:
            return value
        values: list[Any] = [value]
        broadcast_object_list(values)
        result: _Value = values[0]
        return result

    def sum_gradients(self, weights: Iterable[nn.Parameter]) -> None:
        """Sum the gradients of each weight over all processes.

        Weights that have no gradient in any process stay without one.
        """
        if self.size == 1:
            return
        parameters = list(weights)
        has_gradient = torch.tensor([float(weight.grad is not None) for weight in parameters])
        counts = reduce(has_gradient.to(self._state.device), reduction="sum").tolist()
        shared = [weight for weight, count in zip(parameters, counts, strict=True) if count]
        pending = []
        for weight in shared:
            if weight.grad is None:
                weight.grad = torch.zeros_like(weight)
            pending.append(all_reduce(weight.grad, async_op=True))
        for operation in pending:
            operation.wait()

    def hand_out(self, tensors: Iterable[Tensor]) -> None:
        """Overwrite each tensor with that of the leading process."""
        if self.size > 1:
            broadcast(list(tensors))
