"""What others do while participants are measured."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Coroutine, Iterable
from contextlib import asynccontextmanager, suppress


@asynccontextmanager
async def beside(others: Iterable[Coroutine[None, None, None]]) -> AsyncIterator[None]:
    """Let others run during the block, and stop them at its end."""
    tasks = [asyncio.create_task(other) for other in others]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        for task in tasks:
            with suppress(asyncio.CancelledError):
                await task
