"""A store on this machine that is as strict as S3: it checks signatures (AWS Signature Version 4),
their age and digests, and records requests.

It knows one bucket, by path.
"""

import base64
import hashlib
import io
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from urllib.parse import parse_qsl, quote, urlencode, urlsplit
from wsgiref.types import StartResponse, WSGIEnvironment
from xml.sax.saxutils import escape

import pytest
from botocore.auth import S3SigV4Auth
from botocore.awsrequest import AWSRequest
from botocore.credentials import Credentials
from werkzeug.utils import send_file
from werkzeug.wrappers import Request, Response

from tests.support.servers.local_server import listening

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
        return hashlib.md5(self.content, usedforsecurity=False).hexdigest()


@dataclass
class Store:
    """What the stand-in holds and was asked.

    Attributes
    ----------
    endpoint : str
        Where it is reached.
    origins : list of str
        Origins whose pages may load from it.
    asked : list of tuple
        Method, address and headers of every request.
    public : bool
        Whether it sends objects to anybody.
    takes : int or None
        How many more objects it takes before it fails.
    """

    endpoint: str = ""
    objects: dict[str, Stored] = field(default_factory=dict)
    origins: list[str] = field(default_factory=list)
    asked: list[tuple[str, str, dict[str, str]]] = field(default_factory=list)
    public: bool = False
    takes: int | None = None

    def gets(self) -> list[tuple[str, dict[str, str]]]:
        return [(address, headers) for method, address, headers in self.asked if method == "GET"]

    def __call__(self, environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        """Answer a request."""
        request = Request(environ)
        self.asked.append((request.method, environ["REQUEST_URI"], dict(request.headers)))
        return self._answer(request)(environ, start_response)

    def _answer(self, request: Request) -> Response:
        body = request.get_data()
        bucket, _, name = request.path.removeprefix("/").partition("/")
        if bucket != BUCKET:
            return _failure(404, "NoSuchBucket")
        if not (self.public and request.method == "GET") and (refused := _refusal(request, body)):
            return _failure(403, refused)
        if not name:
            return self._list(request)
        if request.method == "PUT":
            return self._put(name, request, body)
        return self._get(name, request)

    def _list(self, request: Request) -> Response:
        start = int(request.args.get("continuation-token", 0))
        names = sorted(n for n in self.objects if n.startswith(request.args.get("prefix", "")))
        stop = start + LIST_AT_ONCE
        contents = "".join(
            f"<Contents><Key>{escape(n)}</Key><Size>{len(self.objects[n].content)}</Size></Contents>"
            for n in names[start:stop]
        )
        more = stop < len(names)
        after = f"<NextContinuationToken>{stop}</NextContinuationToken>" if more else ""
        return _xml(
            f"<ListBucketResult><IsTruncated>{str(more).lower()}</IsTruncated>"
            f"{after}{contents}</ListBucketResult>"
        )

    def _put(self, name: str, request: Request, body: bytes) -> Response:
        digest = base64.b64encode(hashlib.md5(body, usedforsecurity=False).digest()).decode()
        if request.headers.get("Content-MD5") != digest:
            return _failure(400, "BadDigest")
        if self.takes is not None:
            if not self.takes:
                return _failure(403, "QuotaExceeded")
            self.takes -= 1
        kept = {
            header: value
            for header, value in request.headers.items()
            if header.lower().startswith(("content-type", "cache-control", "x-amz-meta-"))
        }
        self.objects[name] = Stored(body, kept, datetime.now(UTC))
        return Response()

    def _get(self, name: str, request: Request) -> Response:
        found = self.objects.get(name)
        if found is None:
            return _failure(404, "NoSuchKey")
        answer = send_file(
            io.BytesIO(found.content),
            request.environ,
            mimetype="application/octet-stream",
            conditional=True,
            etag=found.etag,
            last_modified=found.modified,
        )
        answer.headers.update(found.headers)
        origin = request.headers.get("Origin")
        if origin in self.origins:
            answer.headers.update({"Access-Control-Allow-Origin": str(origin), "Vary": "Origin"})
        return answer


def _xml(text: str, status: int = 200) -> Response:
    return Response(text, status, mimetype="application/xml")


def _failure(status: int, code: str) -> Response:
    return _xml(f"<Error><Code>{code}</Code><Message>{code}</Message></Error>", status)


def _refusal(request: Request, body: bytes) -> str:
    """Return why a request is refused; empty if it is signed correctly."""
    parts = urlsplit(request.environ["REQUEST_URI"])
    given = dict(parse_qsl(parts.query, keep_blank_values=True))
    if "X-Amz-Signature" in given:
        moment, credential = given["X-Amz-Date"], given["X-Amz-Credential"]
        made = datetime.strptime(moment, "%Y%m%dT%H%M%SZ").replace(tzinfo=UTC)
        if datetime.now(UTC) > made + timedelta(seconds=int(given["X-Amz-Expires"])):
            return "AccessDenied"
        names, payload = given["X-Amz-SignedHeaders"], "UNSIGNED-PAYLOAD"
        wanted = given.pop("X-Amz-Signature")
    elif "Authorization" in request.headers:
        _, _, rest = request.headers["Authorization"].partition(" ")
        said = dict(part.strip().split("=", 1) for part in rest.split(","))
        credential, names = said["Credential"], said["SignedHeaders"]
        moment, wanted = request.headers["X-Amz-Date"], said["Signature"]
        payload = request.headers["X-Amz-Content-Sha256"]
        if payload not in ("UNSIGNED-PAYLOAD", hashlib.sha256(body).hexdigest()):
            return "XAmzContentSHA256Mismatch"
    else:
        return "AccessDenied"
    query = urlencode(given, quote_via=quote, safe="-_.~")
    headers = {name: request.headers.get(name, "") for name in names.split(";")}
    again = AWSRequest(request.method, f"http://{request.host}{parts.path}?{query}", headers)
    again.context["timestamp"] = moment
    signer = S3SigV4Auth(Credentials(KEY, SECRET), "s3", REGION)
    canonical = "\n".join((*signer.canonical_request(again).splitlines()[:-1], payload))
    found = signer.signature(signer.string_to_sign(again, canonical), again)
    is_signed = (credential, wanted) == (f"{KEY}/{signer.credential_scope(again)}", found)
    return "" if is_signed else "SignatureDoesNotMatch"


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
    with listening(store) as store.endpoint:
        yield store
