"""What the kernel knows about running processes."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path


def children(pid: int) -> tuple[int, ...]:
    """Return the processes that process `pid` has started and that still run."""
    try:
        listed = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
    except OSError:
        return ()
    return tuple(int(child) for child in listed.split())


def family(pid: int) -> tuple[int, ...]:
    """Return process `pid`, its children, and theirs."""
    return (pid, *(member for child in children(pid) for member in family(child)))


def cpu_seconds(pid: int) -> float:
    """Return the processor time that process `pid` has used; 0 when it is gone."""
    with suppress(OSError):
        # The name, in brackets, may hold anything; user and system time are fields 14 and 15.
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return 0.0


def is_running(pid: int) -> bool:
    """Tell whether process `pid` exists and has not ended."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in ("Z", "X")
