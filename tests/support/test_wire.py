from __future__ import annotations

import asyncio
from contextlib import suppress

import pytest

from tests.support.wire import LostConnectionError, Wire

ANSWER = b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nhi"


async def asked_twice(*answers_of_a_connection: int) -> list[int]:
    """Ask twice over a server whose connections each give so many answers, then close."""
    left = iter(answers_of_a_connection)
    ended: list[asyncio.Event] = []

    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        ended.append(asyncio.Event())
        with suppress(asyncio.IncompleteReadError):
            for _ in range(next(left)):
                await reader.readuntil(b"\r\n\r\n")
                writer.write(ANSWER)
            await reader.readuntil(b"\r\n\r\n")
        writer.close()
        await writer.wait_closed()
        ended[-1].set()

    server = await asyncio.start_server(answer, "127.0.0.1", 0)
    try:
        async with server, Wire("127.0.0.1", server.sockets[0].getsockname()[1]) as wire:
            return [(await wire.get("/")).status for _ in range(2)]
    finally:
        for one in ended:
            await one.wait()


def test_a_request_to_an_idle_connection_that_closes_is_sent_on_another_one() -> None:
    assert asyncio.run(asked_twice(1, 1)) == [200, 200]


def test_a_new_connection_that_closes_is_lost() -> None:
    with pytest.raises(LostConnectionError):
        asyncio.run(asked_twice(0, 1))
