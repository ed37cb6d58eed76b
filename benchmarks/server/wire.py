"""HTTP over one kept-alive connection, as light as can be: the client must not be what is measured.

It reads what this project's server sends: answers with a stated length.
"""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Self
from urllib.parse import urlencode

LARGEST_PART: Final = 1 << 20
NO_HEADERS: Final[Mapping[str, str]] = {}


class LostConnectionError(Exception):
    """The server went away before its answer was whole; nobody knows what it has done."""


@dataclass(frozen=True, kw_only=True)
class Reply:
    """An answer of the server.

    Attributes
    ----------
    headers : mapping of str to str
        By names in small letters.
    """

    status: int
    headers: Mapping[str, str]
    body: bytes


class Wire:
    """A connection that is opened on demand, and again after the server has closed it."""

    def __init__(self, host: str, port: int) -> None:
        self._host, self._port = host, port
        self._lines: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    async def __aenter__(self) -> Self:
        """Give the connection, not yet opened."""
        return self

    async def __aexit__(self, *_: object) -> None:
        """Close the connection."""
        self.close()

    def close(self) -> None:
        """Close the connection; the next request opens another one."""
        if self._lines is not None:
            self._lines[1].close()
        self._lines = None

    async def get(self, path: str, headers: Mapping[str, str] = NO_HEADERS) -> Reply:
        """Fetch `path`."""
        return await self._ask("GET", path, headers, b"")

    async def post(self, path: str, body: bytes, kind: str, accept: str = "text/html") -> Reply:
        """Send `body` of the content type `kind` to `path`."""
        return await self._ask("POST", path, {"Content-Type": kind, "Accept": accept}, body)

    async def post_form(self, path: str, fields: Mapping[str, str]) -> Reply:
        """Send a form to `path`."""
        body = urlencode(fields).encode()
        return await self.post(path, body, "application/x-www-form-urlencoded")

    async def _ask(self, method: str, path: str, headers: Mapping[str, str], body: bytes) -> Reply:
        """Send a request and return its answer.

        Like a browser, it sends the request once more on a new connection where the server closed
        an idle one just as the request was sent.

        Raises
        ------
        LostConnectionError
            If the server cannot be reached or goes away.
        """
        lines = [f"{method} {path} HTTP/1.1", f"Host: {self._host}"]
        lines += [f"{name}: {value}" for name, value in headers.items()]
        if method == "POST":
            lines.append(f"Content-Length: {len(body)}")
        request = "\r\n".join((*lines, "", "")).encode() + body
        was_open = self._lines is not None
        try:
            return await self._sent(request)
        except (OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError) as error:
            self.close()
            if was_open and (isinstance(error, OSError) or not getattr(error, "partial", b"-")):
                return await self._ask(method, path, headers, body)
            raise LostConnectionError(type(error).__name__) from error

    async def _sent(self, request: bytes) -> Reply:
        reader, writer = await self._opened()
        writer.write(request)
        await writer.drain()
        return await self._read(reader)

    async def _opened(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        if self._lines is None or self._lines[0].at_eof():
            self.close()
            self._lines = await asyncio.open_connection(self._host, self._port, limit=LARGEST_PART)
        return self._lines

    async def _read(self, reader: asyncio.StreamReader) -> Reply:
        head = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1")
        first, *lines = head.rstrip("\r\n").split("\r\n")
        headers = {
            name.lower(): value.strip()
            for name, _, value in (line.partition(":") for line in lines)
        }
        body = await reader.readexactly(int(headers.get("content-length", "0")))
        if headers.get("connection", "").lower() == "close":
            self.close()
        return Reply(status=int(first.split(" ", 2)[1]), headers=headers, body=body)
