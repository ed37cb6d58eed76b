"""Participants who send one report after another of a video that they play in very many parts."""

from __future__ import annotations

import json
import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from benchmarks.server.beside import beside
from studyapp.services.watch_evidence import MOST_INTERVALS, MOST_REPORTS
from tests.support.page_scan import SeenVideo, seen_videos
from tests.support.study_server import HOST
from tests.support.visitor import Ledger, Visitor
from tests.support.wire import Wire


@asynccontextmanager
async def report_flood(port: int, count: int) -> AsyncIterator[None]:
    """Let `count` participants each send the largest reports during the block, without a pause."""
    async with beside(_flood(port, number) for number in range(count)):
        yield


async def _flood(port: int, number: int) -> None:
    async with Wire(HOST, port) as wire:
        chance = random.Random(f"flood {number}")  # noqa: S311 - repeatable, not secret
        visitor = Visitor(wire=wire, ledger=Ledger(), chance=chance)
        page = await visitor.begin(await visitor.enrol())
        while True:
            for video in seen_videos(page):
                for batch in range(MOST_REPORTS):
                    body = _largest_report(video, batch)
                    await wire.post(video.watched_address, body, "application/json")


def _largest_report(video: SeenVideo, batch: int) -> bytes:
    step = video.duration / MOST_INTERVALS
    intervals = [[part * step, (part + 0.001) * step] for part in range(MOST_INTERVALS)]
    return json.dumps({"batch": batch, "intervals": intervals}).encode()
