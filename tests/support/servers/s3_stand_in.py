"""A store on this machine that is as strict as S3: it checks signatures (AWS Signature Version 4),
their age and digests, and records requests.

It knows one bucket, by path.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qsl, quote, unquote, urlsplit
from xml.etree import ElementTree
from xml.sax.saxutils import escape

import pytest

from tests.support.servers.local_server import answering

KEY = "AKIASTANDIN"
SECRET = "a-secret-that-must-never-be-seen"  # noqa: S105 - of this stand-in alone
REGION = "here-1"
BUCKET = "study-videos"
LIST_AT_ONCE = 7


@dataclass(frozen=True)
class Stored:
    """An object."""

    content: bytes
    headers: dict[str, str]
    modified: datetime

    @property
    def etag(self) -> str:
        return f'"{hashlib.md5(self.content, usedforsecurity=False).hexdigest()}"'


@dataclass
class Store:
    """What the stand-in holds and was asked.

    Attributes
    ----------
    origins : list of str
        Origins whose pages may load from it.
    asked : list of tuple
        Method, address and headers of every request.
    public : bool
        Whether it sends objects to anybody.
    takes : int or None
        How many more objects it takes before it fails.
    """

    port: int = 0
    objects: dict[str, Stored] = field(default_factory=dict)
    origins: list[str] = field(default_factory=list)
    asked: list[tuple[str, str, dict[str, str]]] = field(default_factory=list)
    public: bool = False
    takes: int | None = None
    now: datetime | None = None

    @property
    def endpoint(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def moment(self) -> datetime:
        return self.now or datetime.now(UTC)

    def gets(self) -> list[tuple[str, dict[str, str]]]:
        return [(address, headers) for method, address, headers in self.asked if method == "GET"]


def _mac(key: bytes, text: str) -> bytes:
    return hmac.digest(key, text.encode(), hashlib.sha256)


def signature(
    method: str,
    path: str,
    query: list[tuple[str, str]],
    headers: list[tuple[str, str]],
    payload: str,
    moment: str,
    scope: str,
) -> str:
    """Return a signature as AWS's documentation of Signature Version 4 says."""
    encoded = sorted((quote(name, safe="-_.~"), quote(value, safe="-_.~")) for name, value in query)
    canonical = "\n".join(
        (
            method,
            path,
            "&".join(f"{name}={value}" for name, value in encoded),
            "".join(f"{name}:{value}\n" for name, value in headers),
            ";".join(name for name, _ in headers),
            payload,
        )
    )
    digest = hashlib.sha256(canonical.encode()).hexdigest()
    key = f"AWS4{SECRET}".encode()
    for part in scope.split("/"):
        key = _mac(key, part)
    return _mac(key, "\n".join(("AWS4-HMAC-SHA256", moment, scope, digest))).hex()


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    store: Store

    def log_message(self, *_: object) -> None:
        """Say nothing."""

    def handle_one(self) -> None:
        length = int(self.headers.get("Content-Length", 0))
        if self.headers.get("Expect") == "100-continue":
            self.send_response_only(100)
            self.end_headers()
        body = self.rfile.read(length)
        self.store.asked.append((self.command, self.path, dict(self.headers.items())))
        parts = urlsplit(self.path)
        query = parse_qsl(parts.query, keep_blank_values=True)
        _, bucket, *rest = parts.path.split("/", 2)
        name = unquote(rest[0]) if rest else ""
        refused = self._refusal(parts.path, query, body)
        if bucket != BUCKET:
            self._fail(404, "NoSuchBucket")
        elif refused and not (self.store.public and self.command == "GET"):
            self._fail(403, refused)
        elif not name:
            self._bucket(dict(query), body)
        else:
            getattr(self, f"_{self.command.lower()}_object")(name, body)

    do_GET = do_PUT = do_DELETE = do_HEAD = handle_one  # noqa: N815 - the library's names

    def _refusal(self, path: str, query: list[tuple[str, str]], body: bytes) -> str:
        """Return why a request is refused; empty if it is signed correctly."""
        given = dict(query)
        if "X-Amz-Signature" in given:
            moment, scope = given["X-Amz-Date"], given["X-Amz-Credential"].partition("/")[2]
            made = datetime.strptime(moment, "%Y%m%dT%H%M%SZ").replace(tzinfo=UTC)
            if self.store.moment() > made + timedelta(seconds=int(given["X-Amz-Expires"])):
                return "AccessDenied"
            names, payload = given["X-Amz-SignedHeaders"], "UNSIGNED-PAYLOAD"
            known, wanted = given["X-Amz-Credential"].partition("/")[0], given["X-Amz-Signature"]
            query = [pair for pair in query if pair[0] != "X-Amz-Signature"]
        elif "Authorization" in self.headers:
            _, _, rest = self.headers["Authorization"].partition(" ")
            said = dict(part.strip().split("=", 1) for part in rest.split(","))
            known, _, scope = said["Credential"].partition("/")
            moment, names = self.headers["X-Amz-Date"], said["SignedHeaders"]
            wanted, payload = said["Signature"], self.headers["X-Amz-Content-Sha256"]
            if payload not in ("UNSIGNED-PAYLOAD", hashlib.sha256(body).hexdigest()):
                return "XAmzContentSHA256Mismatch"
        else:
            return "AccessDenied"
        headers = [(n, " ".join(self.headers.get(n, "").split())) for n in names.split(";")]
        found = signature(self.command, path, query, headers, payload, moment, scope)
        return (
            "" if known == KEY and hmac.compare_digest(found, wanted) else "SignatureDoesNotMatch"
        )

    def _bucket(self, query: dict[str, str], body: bytes) -> None:
        if "cors" in query and self.command == "PUT":
            self.store.origins = [
                found.text or ""
                for found in ElementTree.fromstring(body).iter()  # noqa: S314 - made by boto3
                if found.tag.endswith("AllowedOrigin")
            ]
            self._send(200, b"")
        elif "cors" in query and not self.store.origins:
            self._fail(404, "NoSuchCORSConfiguration")
        elif "cors" in query:
            rules = "".join(
                f"<CORSRule><AllowedOrigin>{escape(each)}</AllowedOrigin>"
                "<AllowedMethod>GET</AllowedMethod></CORSRule>"
                for each in self.store.origins
            )
            self._send(200, f"<CORSConfiguration>{rules}</CORSConfiguration>".encode())
        else:
            self._list(query)

    def _list(self, query: dict[str, str]) -> None:
        start = int(query.get("continuation-token", 0))
        names = sorted(n for n in self.store.objects if n.startswith(query.get("prefix", "")))
        shown = names[start : start + LIST_AT_ONCE]
        more = start + len(shown) < len(names)
        contents = "".join(
            f"<Contents><Key>{escape(n)}</Key><Size>{len(self.store.objects[n].content)}</Size>"
            "</Contents>"
            for n in shown
        )
        after = f"<NextContinuationToken>{start + len(shown)}</NextContinuationToken>"
        self._send(
            200,
            f"<ListBucketResult><IsTruncated>{str(more).lower()}</IsTruncated>"
            f"{after if more else ''}{contents}</ListBucketResult>".encode(),
        )

    def _put_object(self, name: str, body: bytes) -> None:
        digest = base64.b64encode(hashlib.md5(body, usedforsecurity=False).digest()).decode()
        if self.headers.get("Content-MD5") != digest:
            self._fail(400, "BadDigest")
            return
        if self.store.takes is not None:
            if not self.store.takes:
                self._fail(403, "QuotaExceeded")
                return
            self.store.takes -= 1
        kept = {
            header: value
            for header, value in self.headers.items()
            if header.lower() in ("content-type", "cache-control")
            or header.lower().startswith("x-amz-meta-")
        }
        self.store.objects[name] = Stored(body, kept, self.store.moment())
        self._send(200, b"")

    def _delete_object(self, name: str, _body: bytes) -> None:
        self.store.objects.pop(name, None)
        self._send(204, b"")

    def _get_object(self, name: str, _body: bytes) -> None:
        found = self.store.objects.get(name)
        if found is None:
            self._fail(404, "NoSuchKey")
            return
        headers = found.headers | {
            "ETag": found.etag,
            "Last-Modified": format_datetime(found.modified, usegmt=True),
            "Accept-Ranges": "bytes",
        }
        origin = self.headers.get("Origin")
        if origin in self.store.origins:
            headers |= {"Access-Control-Allow-Origin": str(origin), "Vary": "Origin"}
        asked = self.headers.get("Range", "").removeprefix("bytes=")
        size = len(found.content)
        if not asked:
            self._send(200, found.content, headers)
            return
        first, _, last = asked.partition("-")
        stop = min(int(last) + 1 if last else size, size)
        headers["Content-Range"] = f"bytes {first}-{stop - 1}/{size}"
        self._send(206, found.content[int(first) : stop], headers)

    def _fail(self, status: int, code: str) -> None:
        self._send(status, f"<Error><Code>{code}</Code><Message>{code}</Message></Error>".encode())

    def _send(self, status: int, body: bytes, headers: dict[str, str] | None = None) -> None:
        self.send_response(status)
        for name, value in (headers or {"Content-Type": "application/xml"}).items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


ENVIRONMENT = {
    "AWS_ACCESS_KEY_ID": KEY,
    "AWS_SECRET_ACCESS_KEY": SECRET,
    "AWS_DEFAULT_REGION": REGION,
    "AWS_EC2_METADATA_DISABLED": "true",
}
"""With which boto3 finds the store's keys, and nobody else's."""


def use_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let boto3 find the store's keys, and nobody else's."""
    for name in [name for name in os.environ if name.startswith("AWS_")]:
        monkeypatch.delenv(name)
    for name, value in ENVIRONMENT.items():
        monkeypatch.setenv(name, value)
    forget_keys(monkeypatch)


def forget_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let boto3 look for keys again: once found, it keeps them."""
    monkeypatch.setattr("boto3.DEFAULT_SESSION", None)


@contextmanager
def s3_stand_in() -> Iterator[Store]:
    """Run a store during the block."""
    store = Store()
    handler = type("Handler", (_Handler,), {"store": store})
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    server.daemon_threads = True
    store.port = server.server_address[1]
    with answering(server):
        yield store
