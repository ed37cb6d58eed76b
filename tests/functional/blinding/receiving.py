"""A participant whose browser keeps everything it receives, over a whole study session."""

import hashlib
import re
from collections.abc import Iterator
from typing import Any, Final

from flask import Flask
from werkzeug.test import TestResponse

from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import filled
from tests.support.studies.taking_part_steps import SetClock

MOST_STEPS: Final = 40

ASKED: Final[tuple[tuple[str, dict[str, str]], ...]] = (
    ("GET", {"Range": "bytes=0-"}),
    ("HEAD", {}),
    ("GET", {"If-Modified-Since": "Thu, 01 Jan 2026 00:00:00 GMT", "If-None-Match": "a"}),
)
"""Method and headers of the requests for each video."""

EXPIRES: Final = re.compile(r"Expires=[^;]*;")
"""Of a cookie, which counts by the clock of this machine."""

QUESTION: Final = re.compile(rb"<legend>.*?</legend>", re.DOTALL)
"""The words of a question: those of an attention check say by their nature what it is."""

HOLDERS: Final = {"moov", "trak", "mdia", "minf", "stbl", "edts", "dinf", "udta"}
"""Boxes that hold nothing but boxes (ISO/IEC 14496-12)."""

COUNTED: Final = {"stsz": 12, "stco": 8}
"""Tables with the size and position of each encoded picture and each piece of sound. They follow
from what is seen and heard; their number does not, and precedes them."""

WRITTEN: Final = re.compile(rb"[\x20-\x7e]{16,}")
"""What somebody wrote into a file; encoded pictures hold so long a run by chance but rarely."""

Received = tuple[object, ...]
"""Status, headers and content of a response; of a video, what is not its picture or sound."""


class Recorder:
    """Takes part in the study of an application whose clock the test moves.

    Parameters
    ----------
    questions : bool
        Whether the words of the questions are kept, and with them the lengths of pages.
    """

    def __init__(self, app: Flask, clock: SetClock, *, questions: bool) -> None:
        self._client, self._clock, self._questions = app.test_client(), clock, questions
        self.received: list[Received] = []

    def take_part(self) -> list[Received]:
        """Take part from the first page to the completion code; return everything received."""
        address = self._send(PageReader(self._client.get("/").text)).location
        for _ in range(MOST_STEPS):
            answer = self._client.get(address)
            page = PageReader(answer.text)
            if page.soup.select("#completion-code"):
                return self.received
            self._keep(answer)
            if page.soup.select("#answers"):
                refused = self._open("POST", page.action, data=filled(page))
                assert refused.status_code == 422, "answers were taken before anything was played"
                self._watch(page)
            self._send(page)
        raise AssertionError(f"no end after {MOST_STEPS} pages")

    def _watch(self, page: PageReader) -> None:
        for video in page.soup.select("video"):
            for method, headers in ASKED:
                self._open(method, str(video["src"]), headers=headers)
            seconds = float(str(video["data-duration"]))
            self._clock.advance(seconds=seconds + 1)
            report = {"batch": 0, "intervals": [[0.0, seconds]]}
            self._open("POST", str(video["data-watched-url"]), json=report)
            for following in str(video.get("data-following") or "").split():
                self._open("GET", following)

    def _send(self, page: PageReader) -> TestResponse:
        answer = self._open("POST", page.action, data=filled(page))
        assert answer.status_code == 303, page.heading
        return answer

    def _open(self, method: str, address: str, **sent: Any) -> TestResponse:
        answer = self._client.open(address, method=method, buffered=True, **sent)
        self._keep(answer)
        return answer

    def _keep(self, answer: TestResponse) -> None:
        headers = [(name, EXPIRES.sub("", value)) for name, value in answer.headers]
        content = answer.data
        if answer.mimetype == "video/mp4":
            self.received.append((answer.status_code, headers, described(content)))
            return
        if not self._questions:
            headers = [header for header in headers if header[0] != "Content-Length"]
            content = QUESTION.sub(b"", content)
        self.received.append((answer.status_code, headers, content))


def described(video: bytes) -> tuple[tuple[str, str | int], ...]:
    """Return what the boxes of `video` say.

    Left out is what follows from the encoded pictures and sound alone: these themselves, the
    bytes each of them has, and the padding that makes up for their sum.
    """
    facts: list[tuple[str, str | int]] = [("bytes", len(video))]
    facts += [("text", text.decode()) for text in WRITTEN.findall(video)]
    for name, content in _boxes(video, 0, len(video), ""):
        if name not in ("/mdat", "/free"):
            stated = content[: COUNTED.get(name.rpartition("/")[2], len(content))]
            facts += [(name, len(content)), (name, hashlib.sha256(stated).hexdigest())]
        elif name == "/mdat":
            facts.append((name, "is here"))
    return tuple(facts)


def _boxes(data: bytes, start: int, stop: int, inside: str) -> Iterator[tuple[str, bytes]]:
    """Yield the way to each box that holds no others, and its content."""
    while start + 8 <= stop:
        size = int.from_bytes(data[start : start + 4], "big")
        kind = data[start + 4 : start + 8].decode("latin-1")
        assert size >= 8, f"a broken box {kind!r} at byte {start}"
        if kind in HOLDERS:
            yield from _boxes(data, start + 8, start + size, f"{inside}/{kind}")
        else:
            yield f"{inside}/{kind}", data[start + 8 : start + size]
        start += size
