"""Participants with very slow connections, who read a video a few bytes at a time."""

import asyncio
import random
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Final

from benchmarks.server.load import beside
from benchmarks.server.page_scan import seen_videos
from benchmarks.server.visitor import Ledger, Visitor
from benchmarks.server.wire import Wire
from tests.support.servers.study_server import HOST

BYTES: Final = 1024
EVERY_SECONDS: Final = 0.25
"""Four kilobytes a second."""

SEGMENT_BYTES: Final = 1400
BUFFER_BYTES: Final = 4096
"""Buffer as on an internet connection; the loopback would take a whole video at once."""


@asynccontextmanager
async def slow_readers(port: int, count: int) -> AsyncIterator[None]:
    """Let `count` participants read a video very slowly during the block."""
    sources = [await _source(port, number) for number in range(count)]
    async with beside(_read(port, source) for source in sources):
        yield


async def _source(port: int, number: int) -> str:
    """Bring a participant to the first trial, and return the address of one of its videos."""
    async with Wire(HOST, port) as wire:
        chance = random.Random(f"slow {number}")  # noqa: S311 - repeatable, not secret
        visitor = Visitor(wire=wire, ledger=Ledger(), chance=chance)
        page = await visitor.begin(await visitor.enrol())
        return seen_videos(page)[0].source


async def _read(port: int, source: str) -> None:
    loop = asyncio.get_running_loop()
    request = f"GET {source} HTTP/1.1\r\nHost: {HOST}\r\nRange: bytes=0-\r\n\r\n".encode()
    while True:
        with socket.socket() as line:
            line.setblocking(False)
            line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_MAXSEG, SEGMENT_BYTES)
            await loop.sock_connect(line, (HOST, port))
            await loop.sock_sendall(line, request)
            while await loop.sock_recv(line, BYTES):
                await asyncio.sleep(EVERY_SECONDS)
