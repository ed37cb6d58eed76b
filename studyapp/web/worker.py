"""gunicorn's worker: no thread waits for a line, and its log quotes no request."""

from __future__ import annotations

import os
import re
import selectors
import socket
import time
import traceback
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any, ClassVar, Final

from gunicorn import util  # type: ignore[import-untyped]
from gunicorn.http import errors, get_parser  # type: ignore[import-untyped]
from gunicorn.workers.base import Worker  # type: ignore[import-untyped]
from gunicorn.workers.gthread import ThreadWorker  # type: ignore[import-untyped]

from studyapp.web.app import LARGEST_REQUEST

BAD_REQUEST: Final = (400, "Bad Request")
LENGTH_REQUIRED: Final = (411, "Length Required")
HEAD_TOO_LARGE: Final = (431, "Request Header Fields Too Large")
REFUSALS: Final[dict[type[Exception], tuple[int, str]]] = {
    errors.LimitRequestLine: (414, "URI Too Long"),
    errors.LimitRequestHeaders: HEAD_TOO_LARGE,
    errors.ExpectationFailed: (417, "Expectation Failed"),
    errors.UnsupportedTransferCoding: (501, "Not Implemented"),
    errors.ForbiddenProxyRequest: (403, "Forbidden"),
}
"""What is no request of HTTP as it should be, and is not answered with `BAD_REQUEST`."""

OWN_FAULTS: Final = (
    errors.InvalidResponseHeader,
    errors.InvalidResponseHeaderName,
    errors.ConfigurationProblem,
)

LARGEST_HEAD: Final = 64 * 1024
REQUEST_SECONDS: Final = 30.0
"""Within which a request must have come whole, from its first byte on."""

SENDING_SECONDS: Final = 60.0
"""For how long the other side may take nothing of an answer."""

CLOSING_SECONDS: Final = 2.0
HELD_SECONDS: Final = 1.0
"""How long an answer is kept back that asks for patience, so that nobody asks again at once."""

ASKS_FOR_PATIENCE: Final = b"HTTP/1.1 429 "
BLOCK: Final = 1 << 16

END_OF_HEAD: Final = b"\r\n\r\n"
BODY_LENGTH: Final = re.compile(rb"\r\ncontent-length[ \t]*:[ \t]*([0-9]{1,18})[ \t]*\r\n", re.I)
IN_CHUNKS: Final = re.compile(rb"\r\ntransfer-encoding[ \t]*:", re.I)
ASKS_TO_GO_ON: Final = re.compile(rb"\r\nexpect[ \t]*:[ \t]*100-continue[ \t]*\r\n", re.I)
GO_ON: Final = b"HTTP/1.1 100 Continue\r\n\r\n"


class Line(socket.socket):
    """A participant's line. What is sent stays here until the other side takes it."""

    def __init__(self, accepted: socket.socket) -> None:
        super().__init__(fileno=accepted.detach())
        self.setblocking(False)
        self._unsent: deque[memoryview | tuple[int, int, int]] = deque()
        self.is_held = False

    def sendall(self, data: Any, flags: int = 0, /) -> None:
        """Keep `data` until it can be sent."""
        self._unsent.append(memoryview(bytes(data)))
        self.is_held = self.is_held or data[: len(ASKS_FOR_PATIENCE)] == ASKS_FOR_PATIENCE

    def sendfile(self, file: Any, offset: int = 0, count: int | None = None) -> int:
        """Keep a part of `file` until it can be sent; the file itself may be closed."""
        descriptor = os.dup(file.fileno())
        size = os.fstat(descriptor).st_size - offset if count is None else count
        self._unsent.append((descriptor, offset, offset + size))
        return size

    @property
    def is_sent(self) -> bool:
        """Whether the other side has taken everything."""
        return not self._unsent

    def send_on(self) -> bool:
        """Send what can be sent at once; tell whether anything was."""
        moved = False
        with suppress(BlockingIOError):
            while self._unsent:
                first = self._unsent[0]
                if isinstance(first, memoryview):
                    rest: memoryview | tuple[int, int, int] = first[self.send(first) :]
                    done = not rest
                else:
                    descriptor, start, stop = first
                    sent = os.sendfile(self.fileno(), descriptor, start, stop - start)
                    if sent == 0 and start < stop:
                        raise EOFError
                    rest, done = (descriptor, start + sent, stop), start + sent == stop
                    if done:
                        os.close(descriptor)
                self._unsent[0] = rest
                if done:
                    self._unsent.popleft()
                moved = True
        return moved

    def close(self) -> None:
        """Close it, whatever was not sent."""
        for kept in self._unsent:
            if isinstance(kept, tuple):
                os.close(kept[0])
        self._unsent.clear()
        super().close()


class StudyWorker(ThreadWorker):  # type: ignore[misc]
    """A process that handles requests in threads.

    A thread is given a request when all of it is there, and is free again when the answer is made:
    whoever sends or reads slowly costs a connection, and no thread. Where connections run out,
    those go first that have kept the worker waiting longest.

    gunicorn's own words about a request that cannot be read, or that fails, quote it: its
    address holds a participant's token.

    Attributes
    ----------
    largest_request : int
        Bytes that a request may have beyond its head.
    """

    largest_request: ClassVar[int] = LARGEST_REQUEST

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._until: dict[Any, float] = {}
        """Until when each line is waited for that no thread has."""
        self._held: deque[tuple[float, Any]] = deque()
        """Lines whose answers are kept back, each with until when."""
        self._looked_at = 0.0

    def handle_quit(self, sig: int, frame: Any) -> None:
        """End at once, on SIGQUIT.

        gunicorn's own handler shuts the pool of threads down first. That waits for ever where the
        signal interrupts this thread just as it hands the pool a request, and holds its lock.
        """
        Worker.handle_quit(self, sig, frame)

    def enqueue_req(self, conn: Any) -> None:
        """Gather a request on a line that is new, or that has been answered."""
        begun = b""
        if conn.parser is None:
            conn.sock, conn.data_ready = Line(conn.sock), True
        else:
            begun = conn.parser.unreader.take_buffered()
        conn.arrived, conn.length, conn.whole = bytearray(begun), None, False
        is_first = conn.parser is None or begun
        self._wait(conn, self._gather, seconds=REQUEST_SECONDS if is_first else self.cfg.keepalive)
        self._gather(conn)

    def _gather(self, conn: Any, _line: object = None) -> None:
        """Take what has arrived, and give the request to a thread once all of it is there."""
        try:
            piece = conn.sock.recv(BLOCK)
        except BlockingIOError:
            # What has come with the request before may be a whole one.
            if not conn.arrived or conn.length is not None:
                return
            piece = None
        except OSError:
            self._drop(conn)
            return
        if piece and not conn.arrived:
            self._until[conn] = time.monotonic() + REQUEST_SECONDS
        conn.arrived += piece or b""
        if conn.length is None:
            refusal = self._measure(conn)
            if refusal is not None:
                self._refuse(conn, *refusal)
                return
        conn.whole = conn.length is not None and len(conn.arrived) >= conn.length
        if piece == b"" and not conn.arrived:
            self._drop(conn)
        elif conn.whole or piece == b"" or self._is_too_large(conn):
            self._stop_waiting(conn)
            # Of this alone: no thread ever reads from the line.
            conn.parser = get_parser(self.cfg, [bytes(conn.arrived)], conn.client)
            super().enqueue_req(conn)

    def _measure(self, conn: Any) -> tuple[int, str] | None:
        """Note how long the request is once its head is there; return why it is refused."""
        head = conn.arrived.find(END_OF_HEAD)
        if head < 0:
            return HEAD_TOO_LARGE if len(conn.arrived) > LARGEST_HEAD else None
        lines = bytes(conn.arrived[: head + len(END_OF_HEAD)])
        if IN_CHUNKS.search(lines):
            return LENGTH_REQUIRED
        found = BODY_LENGTH.search(lines)
        conn.length = len(lines) + (int(found[1]) if found else 0)
        conn.head_length = len(lines)
        if len(conn.arrived) < conn.length and ASKS_TO_GO_ON.search(lines):
            conn.sock.sendall(GO_ON)
            with suppress(OSError):
                conn.sock.send_on()
        return None

    def _is_too_large(self, conn: Any) -> bool:
        return conn.length is not None and conn.length - conn.head_length > self.largest_request

    def handle(self, conn: Any) -> bool:
        """Answer a request, in a thread; return whether another one may follow on the line."""
        keeps = super().handle(conn)
        conn.sock.setblocking(False)
        if not conn.sock.is_held:
            with suppress(OSError, EOFError):
                conn.sock.send_on()
        # Where the next request begins is known only behind a whole one.
        return bool(keeps) and conn.whole

    def finish_request(self, conn: Any, fs: Any) -> None:
        """Send what the thread could not send at once."""
        conn.keeps = not fs.cancelled() and fs.exception() is None and fs.result()
        if conn.sock.is_held:
            self._held.append((time.monotonic() + HELD_SECONDS, conn))
        else:
            self._send(conn)

    def _send(self, conn: Any) -> None:
        conn.sock.is_held = False
        self._wait(conn, self._send_on, seconds=SENDING_SECONDS, to_send=True)
        self._send_on(conn)

    def _send_on(self, conn: Any, _line: object = None) -> None:
        try:
            if conn.sock.send_on():
                self._until[conn] = time.monotonic() + SENDING_SECONDS
        except (OSError, EOFError):
            self._drop(conn)
            return
        if not conn.sock.is_sent:
            return
        self._stop_waiting(conn)
        if conn.keeps:
            self.enqueue_req(conn)
        elif conn.whole:
            self._drop(conn)
        else:
            # Closing over what was not read would take the answer back.
            with suppress(OSError):
                conn.sock.shutdown(socket.SHUT_WR)
            self._wait(conn, self._read_to_end, seconds=CLOSING_SECONDS)

    def _read_to_end(self, conn: Any, _line: object = None) -> None:
        try:
            ended = conn.sock.recv(BLOCK) == b""
        except OSError:
            ended = True
        if ended:
            self._drop(conn)

    def _refuse(self, conn: Any, status: int, reason: str) -> None:
        self._stop_waiting(conn)
        util.write_error(conn.sock, status, reason, "")
        conn.keeps = conn.whole = False
        self._wait(conn, self._send_on, seconds=CLOSING_SECONDS, to_send=True)
        self._send_on(conn)

    def _wait(
        self, conn: Any, go_on: Callable[..., None], *, seconds: float, to_send: bool = False
    ) -> None:
        """Call `callback` whenever something arrives on the line, or can be sent."""
        event = selectors.EVENT_WRITE if to_send else selectors.EVENT_READ
        self.poller.register(conn.sock, event, partial(go_on, conn))
        self._until[conn] = time.monotonic() + seconds

    def _stop_waiting(self, conn: Any) -> None:
        del self._until[conn]
        self.poller.unregister(conn.sock)

    def _drop(self, conn: Any) -> None:
        if conn in self._until:
            self._stop_waiting(conn)
        self.nr_conns -= 1
        conn.sock.close()

    def murder_pending(self) -> None:
        """Close the lines that were waited for long enough, and more where there are too many."""
        now = time.monotonic()
        is_full = self.nr_conns >= self.worker_connections
        while self._held and (is_full or self._held[0][0] <= now or not self.alive):
            self._send(self._held.popleft()[1])
        if not is_full and now - self._looked_at < 1:
            return
        self._looked_at = now
        overdue = [conn for conn in self._until if self._is_overdue(conn, now)]
        if is_full and not overdue:
            longest = sorted(self._until, key=self._until.__getitem__)
            overdue = longest[: max(1, self.worker_connections // 10)]
        for conn in overdue:
            self._drop(conn)

    def _is_overdue(self, conn: Any, now: float) -> bool:
        # Who sends slowly, or has sent nothing yet, does not keep a server from ending.
        hurries = not self.alive and (conn.arrived or conn.parser is None)
        hurry = REQUEST_SECONDS - CLOSING_SECONDS if hurries else 0.0
        return self._until[conn] - hurry <= now

    def handle_error(self, req: Any, client: socket.socket, addr: Any, exc: Exception) -> None:
        """Answer a request that is no HTTP, or that failed outside all pages."""
        del req, addr
        if isinstance(exc, errors.ParseException) and not isinstance(exc, OWN_FAULTS):
            status, reason = REFUSALS.get(type(exc), BAD_REQUEST)
        else:
            status, reason = 500, "Internal Server Error"
            where = "".join(traceback.format_tb(exc.__traceback__))
            self.log.error("Failed outside all pages: %s\n%s", type(exc).__name__, where)
        with suppress(OSError):
            util.write_error(client, status, reason, "")
