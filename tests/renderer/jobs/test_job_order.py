from __future__ import annotations

from pathlib import Path
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from renderer.framing import Camera
from renderer.jobs.job import ClipJob, DubJob, Job, PairJob
from renderer.jobs.making import JobOrder
from renderer.look import Look

CAMERA = Camera(eye=(0, 0, 1), target=(0, 0, 0), field_of_view=20)
SHARED: dict[str, Any] = {"speech": Path("s.wav"), "start": 0.0, "end": 1.0, "look": Look()}


def clip(name: str) -> ClipJob:
    return ClipJob(
        name=name,
        motion=Path(name),
        freeze=(),
        body=None,
        camera=CAMERA,
        frames=Path(f"{name}.mkv"),
        video=Path(f"{name}.mp4"),
        **SHARED,
    )


def pair(left: str, right: str) -> PairJob:
    return PairJob(
        name=f"{left}|{right}",
        left=Path(f"{left}.mkv"),
        right=Path(f"{right}.mkv"),
        video=Path(f"{left}|{right}.mp4"),
        **SHARED,
    )


def dub(picture: str) -> DubJob:
    shared = {key: value for key, value in SHARED.items() if key != "look"}
    return DubJob(
        name=f"{picture}@",
        picture=Path(f"{picture}.mp4"),
        seconds=1.0,
        video=Path(f"{picture}@.mp4"),
        **shared,
    )


def test_another_speech_waits_for_its_clip_and_is_lost_with_it() -> None:
    order = JobOrder([dub("a"), clip("a"), dub("b")])
    assert [order.next() for _ in range(3)] == [1, 2, None]
    assert order.failed(1) == [0]
    assert order.next() is None


def test_pairs_wait_for_both_their_clips() -> None:
    order = JobOrder([clip("a"), clip("b"), pair("a", "b"), clip("c")])
    assert [order.next() for _ in range(4)] == [0, 1, 3, None]
    order.succeeded(0)
    assert order.next() is None
    order.succeeded(1)
    assert order.next() == 2


def test_pairs_of_frames_that_are_there_already_wait_for_nothing() -> None:
    assert JobOrder([pair("x", "y")]).next() == 0


def test_a_ready_pair_goes_before_later_clips() -> None:
    order = JobOrder([clip("a"), pair("a", "a"), clip("b")])
    assert order.next() == 0
    order.succeeded(0)
    assert [order.next(), order.next()] == [1, 2]


def test_a_failed_clip_takes_its_pairs_with_it_once() -> None:
    order = JobOrder([clip("a"), clip("b"), clip("c"), pair("a", "b"), pair("b", "c")])
    assert [order.next() for _ in range(3)] == [0, 1, 2]
    assert order.failed(0) == [3]
    order.succeeded(1)
    assert order.failed(2) == [4]
    assert order.next() is None


@given(data=st.data(), clips=st.integers(1, 6), pairs=st.integers(0, 12))
def test_every_job_is_begun_once_or_lost_once_whatever_fails(
    data: st.DataObject, clips: int, pairs: int
) -> None:
    side = st.integers(0, clips - 1).map(str)
    jobs: list[Job] = [clip(str(number)) for number in range(clips)]
    jobs += [pair(data.draw(side), data.draw(side)) for _ in range(pairs)]
    jobs = data.draw(st.permutations(jobs))
    order, begun, lost, running = JobOrder(jobs), [], [], []
    while True:
        while (number := order.next()) is not None:
            running.append(number)
        if not running:
            break
        number = running.pop(data.draw(st.integers(0, len(running) - 1)))
        begun.append(number)
        if data.draw(st.booleans()):
            order.succeeded(number)
        else:
            lost += order.failed(number)
    assert sorted(begun + lost) == list(range(len(jobs)))
