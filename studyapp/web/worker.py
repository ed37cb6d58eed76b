"""gunicorn's worker: no thread waits for a connection, and its log quotes no request."""

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
OWN_FAULTS: Final = (
    errors.InvalidResponseHeader,
    errors.InvalidResponseHeaderName,
    errors.ConfigurationProblem,
)

LARGEST_HEAD: Final = 64 * 1024
REQUEST_SECONDS: Final = 30.0
"""Within which a request must arrive, from its first byte on."""

SENDING_SECONDS: Final = 60.0
"""For how long a client may read nothing of a response."""

CLOSING_SECONDS: Final = 2.0
DELAY_SECONDS: Final = 1.0
"""How long a 429 is delayed, so that nobody asks again at once."""

TOO_MANY_REQUESTS: Final = b"HTTP/1.1 429 "
BLOCK: Final = 1 << 16

END_OF_HEAD: Final = b"\r\n\r\n"
BODY_LENGTH: Final = re.compile(rb"\r\ncontent-length[ \t]*:[ \t]*([0-9]{1,18})[ \t]*\r\n", re.I)
IN_CHUNKS: Final = re.compile(rb"\r\ntransfer-encoding[ \t]*:", re.I)
EXPECTS_CONTINUE: Final = re.compile(rb"\r\nexpect[ \t]*:[ \t]*100-continue[ \t]*\r\n", re.I)
CONTINUE: Final = b"HTTP/1.1 100 Continue\r\n\r\n"


class BufferedSocket(socket.socket):
    """A participant's connection, which keeps what is sent until the client takes it."""

    def __init__(self, accepted: socket.socket) -> None:
        super().__init__(fileno=accepted.detach())
        self.setblocking(False)
        self._unsent: deque[memoryview | tuple[int, int, int]] = deque()
        self.is_delayed = False

    def sendall(self, data: Any, flags: int = 0, /) -> None:
        """Keep `data` until it can be sent."""
        self._unsent.append(memoryview(bytes(data)))
        self.is_delayed = self.is_delayed or data[: len(TOO_MANY_REQUESTS)] == TOO_MANY_REQUESTS

    def sendfile(self, file: Any, offset: int = 0, count: int | None = None) -> int:
        """Keep a part of `file` until it can be sent; the file itself may be closed."""
        descriptor = os.dup(file.fileno())
        size = os.fstat(descriptor).st_size - offset if count is None else count
        self._unsent.append((descriptor, offset, offset + size))
        return size

    @property
    def is_sent(self) -> bool:
        """Whether the client has taken everything."""
        return not self._unsent

    def flush(self) -> bool:
        """Send what can be sent at once; return whether anything was."""
        sent_any = False
        with suppress(BlockingIOError):
            while self._unsent:
                first = self._unsent[0]
                if isinstance(first, memoryview):
                    remainder: memoryview | tuple[int, int, int] = first[self.send(first) :]
                    done = not remainder
                else:
                    descriptor, start, stop = first
                    sent = os.sendfile(self.fileno(), descriptor, start, stop - start)
                    if sent == 0 and start < stop:
                        raise EOFError
                    remainder, done = (descriptor, start + sent, stop), start + sent == stop
                    if done:
                        os.close(descriptor)
                self._unsent[0] = remainder
                if done:
                    self._unsent.popleft()
                sent_any = True
        return sent_any

    def close(self) -> None:
        """Close it, and drop what was not sent."""
        for part in self._unsent:
            if isinstance(part, tuple):
                os.close(part[0])
        self._unsent.clear()
        super().close()


class StudyWorker(ThreadWorker):  # type: ignore[misc]
    """A process that handles requests in threads.

    A thread is given a request when it has arrived completely, and is free again when the response
    is made: a slow client costs a connection, and no thread. When connections run out, those that
    have kept the worker waiting longest are closed first.

    gunicorn's own messages about faulty and failed requests quote them, and their addresses hold
    participants' tokens.

    Attributes
    ----------
    largest_request : int
        Bytes that the body of a request may have.
    """

    largest_request: ClassVar[int] = LARGEST_REQUEST

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._deadlines: dict[Any, float] = {}
        """Until when to wait for each connection that no thread has."""
        self._delayed: deque[tuple[float, Any]] = deque()
        """Connections whose responses are delayed, each with until when."""
        self._checked_at = 0.0

    def handle_quit(self, sig: int, frame: Any) -> None:
        """End at once, on SIGQUIT.

        gunicorn's own handler shuts the pool of threads down first. That waits for ever where the
        signal interrupts this thread just as it hands the pool a request, and holds its lock.
        """
        Worker.handle_quit(self, sig, frame)

    def is_parent_alive(self) -> bool:
        """Say whether the process that starts workers is there; without it, end as if told to.

        gunicorn's own worker ends too, but lets busy connections go on for half a minute.
        """
        if not super().is_parent_alive():
            self.alive = False
        return self.alive

    def enqueue_req(self, conn: Any) -> None:
        """Receive a request on a connection that is new, or free again."""
        begun = b""
        if conn.parser is None:
            conn.sock, conn.data_ready = BufferedSocket(conn.sock), True
        else:
            begun = conn.parser.unreader.take_buffered()
        conn.received, conn.length, conn.is_complete = bytearray(begun), None, False
        is_first = conn.parser is None or begun
        self._watch(
            conn, self._receive, seconds=REQUEST_SECONDS if is_first else self.cfg.keepalive
        )
        self._receive(conn)

    def _receive(self, conn: Any, _socket: object = None) -> None:
        """Read what has arrived, and give the request to a thread once it is complete."""
        try:
            piece = conn.sock.recv(BLOCK)
        except BlockingIOError:
            # What came with the request before may be a complete one.
            if not conn.received or conn.length is not None:
                return
            piece = None
        except OSError:
            self._drop(conn)
            return
        if piece and not conn.received:
            self._deadlines[conn] = time.monotonic() + REQUEST_SECONDS
        conn.received += piece or b""
        if conn.length is None and not self._read_head(conn):
            self._refuse(conn)
            return
        conn.is_complete = conn.length is not None and len(conn.received) >= conn.length
        if piece == b"" and not conn.received:
            self._drop(conn)
        elif conn.is_complete or piece == b"" or self._is_too_large(conn):
            self._unwatch(conn)
            if not conn.is_complete:
                # So that the response says that the connection ends with it.
                conn.received = conn.received.replace(b"\r\n", b"\r\nConnection: close\r\n", 1)
            # Only of these bytes: no thread ever reads from the connection.
            conn.parser = get_parser(self.cfg, [bytes(conn.received)], conn.client)
            super().enqueue_req(conn)

    def _read_head(self, conn: Any) -> bool:
        """Note how long the request is once its head is there; return False if it is refused."""
        head = conn.received.find(END_OF_HEAD)
        if head < 0:
            return len(conn.received) <= LARGEST_HEAD
        lines = bytes(conn.received[: head + len(END_OF_HEAD)])
        if IN_CHUNKS.search(lines):
            return False
        length = BODY_LENGTH.search(lines)
        conn.length = len(lines) + (int(length[1]) if length else 0)
        conn.head_length = len(lines)
        if len(conn.received) < conn.length and EXPECTS_CONTINUE.search(lines):
            conn.sock.sendall(CONTINUE)
            with suppress(OSError):
                conn.sock.flush()
        return True

    def _is_too_large(self, conn: Any) -> bool:
        return conn.length is not None and conn.length - conn.head_length > self.largest_request

    def handle(self, conn: Any) -> bool:
        """Answer a request, in a thread; return whether the connection is kept for another one."""
        keep_alive = super().handle(conn)
        conn.sock.setblocking(False)
        if not conn.sock.is_delayed:
            with suppress(OSError, EOFError):
                conn.sock.flush()
        # Only behind a complete request is it known where the next one begins.
        return bool(keep_alive) and conn.is_complete

    def finish_request(self, conn: Any, fs: Any) -> None:
        """Send what the thread could not send at once."""
        conn.keep_alive = not fs.cancelled() and fs.exception() is None and fs.result()
        if conn.sock.is_delayed:
            self._delayed.append((time.monotonic() + DELAY_SECONDS, conn))
        else:
            self._send(conn)

    def _send(self, conn: Any) -> None:
        conn.sock.is_delayed = False
        self._watch(conn, self._flush, seconds=SENDING_SECONDS, to_send=True)
        self._flush(conn)

    def _flush(self, conn: Any, _socket: object = None) -> None:
        try:
            if conn.sock.flush():
                self._deadlines[conn] = time.monotonic() + SENDING_SECONDS
        except (OSError, EOFError):
            self._drop(conn)
            return
        if not conn.sock.is_sent:
            return
        self._unwatch(conn)
        if conn.keep_alive:
            self.enqueue_req(conn)
        elif conn.is_complete:
            self._drop(conn)
        else:
            # Closing with unread bytes would reset the connection, and lose the response.
            with suppress(OSError):
                conn.sock.shutdown(socket.SHUT_WR)
            self._watch(conn, self._drain, seconds=CLOSING_SECONDS)

    def _drain(self, conn: Any, _socket: object = None) -> None:
        try:
            ended = conn.sock.recv(BLOCK) == b""
        except OSError:
            ended = True
        if ended:
            self._drop(conn)

    def _refuse(self, conn: Any) -> None:
        self._unwatch(conn)
        util.write_error(conn.sock, *BAD_REQUEST, "")
        conn.keep_alive = conn.is_complete = False
        self._watch(conn, self._flush, seconds=CLOSING_SECONDS, to_send=True)
        self._flush(conn)

    def _watch(
        self, conn: Any, callback: Callable[..., None], *, seconds: float, to_send: bool = False
    ) -> None:
        """Call `callback` whenever something arrives on the connection, or can be sent."""
        event = selectors.EVENT_WRITE if to_send else selectors.EVENT_READ
        self.poller.register(conn.sock, event, partial(callback, conn))
        self._deadlines[conn] = time.monotonic() + seconds

    def _unwatch(self, conn: Any) -> None:
        del self._deadlines[conn]
        self.poller.unregister(conn.sock)

    def _drop(self, conn: Any) -> None:
        if conn in self._deadlines:
            self._unwatch(conn)
        self.nr_conns -= 1
        conn.sock.close()

    def murder_pending(self) -> None:
        """Close connections whose time is over, and more if there are too many."""
        now = time.monotonic()
        is_full = self.nr_conns >= self.worker_connections
        while self._delayed and (is_full or self._delayed[0][0] <= now or not self.alive):
            self._send(self._delayed.popleft()[1])
        if not is_full and now - self._checked_at < 1:
            return
        self._checked_at = now
        overdue = [conn for conn in self._deadlines if self._is_overdue(conn, now)]
        if is_full and not overdue:
            longest = sorted(self._deadlines, key=self._deadlines.__getitem__)
            overdue = longest[: max(1, self.worker_connections // 10)]
        for conn in overdue:
            self._drop(conn)

    def _is_overdue(self, conn: Any, now: float) -> bool:
        # Slow clients do not keep a server from ending.
        is_ending = not self.alive and (conn.received or conn.parser is None)
        shortened = REQUEST_SECONDS - CLOSING_SECONDS if is_ending else 0.0
        return self._deadlines[conn] - shortened <= now

    def handle_error(self, req: Any, client: socket.socket, addr: Any, exc: Exception) -> None:
        """Answer a request that is not HTTP, or that failed outside all pages."""
        del req, addr
        if isinstance(exc, errors.ParseException) and not isinstance(exc, OWN_FAULTS):
            status, reason = BAD_REQUEST
        else:
            status, reason = 500, "Internal Server Error"
            where = "".join(traceback.format_tb(exc.__traceback__))
            self.log.error("Failed outside all pages: %s\n%s", type(exc).__name__, where)
        with suppress(OSError):
            util.write_error(client, status, reason, "")
