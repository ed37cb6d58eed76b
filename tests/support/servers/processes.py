"""What the kernel knows about running processes."""

import os
from pathlib import Path


def children(pid: int) -> tuple[int, ...]:
    """Return the processes that process `pid` has started and that still run."""
    try:
        files = Path(f"/proc/{pid}/task").glob("*/children")
        return tuple(int(child) for file in files for child in file.read_text("ascii").split())
    except OSError:
        return ()


def descendants(pid: int) -> tuple[int, ...]:
    """Return the processes that process `pid` or its descendants have started."""
    return tuple(process for child in children(pid) for process in (child, *descendants(child)))


def cpu_seconds(pid: int) -> float:
    """Return the processor time that process `pid` has used; 0 when it is gone."""
    return sum(_times(pid)[:2])


def family_cpu_seconds(pid: int) -> float:
    """Return the processor time of process `pid`, and of its children, ended ones included."""
    return sum(_times(pid)) + sum(cpu_seconds(child) for child in children(pid))


def _times(pid: int) -> tuple[float, ...]:
    """Return the seconds of process `pid` as user and system, and those of its ended children."""
    try:
        # The name, in brackets, may hold anything; the times are fields 14 to 17.
        text = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8")
    except OSError:
        return (0.0, 0.0, 0.0, 0.0)
    ticks = text.rpartition(")")[2].split()[11:15]
    return tuple(int(tick) / os.sysconf("SC_CLK_TCK") for tick in ticks)


def is_running(pid: int) -> bool:
    """Tell whether process `pid` exists and has not ended."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in ("Z", "X")
