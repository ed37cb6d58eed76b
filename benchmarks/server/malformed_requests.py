"""Random requests that no browser sends."""

import json
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final
from urllib.parse import quote_from_bytes

METHODS: Final = (
    *("GET", "POST", "HEAD", "PUT", "DELETE"),
    *("OPTIONS", "PATCH", "TRACE", "get", "X" * 30),
)
KINDS: Final = (
    "application/x-www-form-urlencoded",
    "application/json",
    "multipart/form-data; boundary=x",
    "multipart/form-data",
    "text/plain; charset=utf-16",
    "application/x-www-form-urlencoded; charset=utf-7",
    "\xff/\xfe",
    "",
)
NUMBERS: Final = (
    *("-1", "0", "--2", "99999999999999999999999", "1" * 5000),
    *("1e999", "NaN", "0x10", "٣"),
)
TEXTS: Final = (
    b"",
    b"\x00",
    b"%00",
    b"\xff\xfe\xfd",
    b"\xed\xa0\x80",
    "𝔘𝔫𝔦".encode(),
    b"../../../etc/passwd",
    b"..%2f..%2fstudy.toml",
    b"' OR 1=1 --",
    b"{{7*7}}",
    b"<script>alert(1)</script>",
    b"%",
    b"%zz",
    b"a" * 9000,
    b"\r\nX-Injected: 1",
)
HEADERS: Final = (
    b"Range: bytes=5-2",
    b"Range: bytes=-0",
    b"Range: bytes=0-1,2-3,4-5",
    b"Range: bytes=99999999999999999999-",
    b"Range: potatoes=1-2",
    b'If-Range: "x"',
    b"If-Modified-Since: yesterday",
    b"Accept: application/json",
    b"Accept: ;;;,,,q=x",
    b"Cookie: \x00=\xff",
    b"Host: [::1",
    b"Host: a b",
    b"X-Forwarded-Proto: https\r\nX-Forwarded-Ssl: off",
    b"Transfer-Encoding: chunked",
    b"Transfer-Encoding: gzip, chunked",
    b"Expect: 100-continue",
    b"Expect: the-unexpected",
    b"Connection: Upgrade\r\nUpgrade: h2c\r\nHTTP2-Settings: AA",
    b"Content-Encoding: gzip",
    b"No colon at all",
    b" Folded: yes",
    b"X: " + b"y" * 9000,
)


@dataclass(frozen=True, kw_only=True)
class Known:
    """Real tokens, with which malformed requests get past the first checks.

    Attributes
    ----------
    pages : sequence of str
        Participants' own pages, ``/take/<token>``.
    trials, videos : sequence of str
        Tokens.
    """

    pages: Sequence[str]
    trials: Sequence[str]
    videos: Sequence[str]


def malformed_requests(count: int, known: Known, seed: int) -> Iterator[bytes]:
    """Yield `count` requests, the same ones for the same `seed`.

    None is valid: a request to a real page's address has content that must be refused.
    """
    chance = random.Random(seed)  # noqa: S311 - it must be repeatable, not secret
    makers = (_lost, _start, _answers, _watched, _form, _media, _not_http)
    for _ in range(count):
        yield chance.choice(makers)(known, chance)


def _lost(known: Known, chance: random.Random) -> bytes:
    """Request missing things in every way."""
    pieces = ("", "take", "media", "static", "take/x", "studyapp", "%2e%2e", ".", "//", "*", "?")
    path = b"/".join(
        (b"", chance.choice(pieces).encode(), *_drawn(TEXTS, chance, chance.randrange(3)), b"lost")
    )
    return _request(chance.choice(METHODS), path, b"", chance)


def _start(known: Known, chance: random.Random) -> bytes:
    """Start without consent or identity."""
    visit = chance.choice((b"short", b"x" * 65, b"with%20blank" * 3, b"\xff" * 30, b""))
    fields = [b"visit=" + visit]
    if chance.random() < 0.5:
        name = chance.choice((b"%00", b"%0a", b"a%20b", b"x" * 201, b"%ff%20"))
        fields.append(b"PROLIFIC_PID=" + name)
    return _request("POST", b"/", b"&".join(fields), chance, KINDS[0])


def _answers(known: Known, chance: random.Random) -> bytes:
    """Answer a trial with invalid answers."""
    trial = chance.choice((*known.trials, "nobody's", "")).encode()
    value = chance.choice((*NUMBERS, "3", "-3", "", "clearly A")).encode()
    fields = [b"trial=" + trial, b"rhythm=" + value]
    fields += [
        chance.choice((b"rhythm=1", b"emotion=7", b"emotion:1=1", b"rhythm:reasons=x", b"z" * 300))
        for _ in range(chance.randrange(4))
    ]
    fields += _drawn(TEXTS, chance, chance.randrange(2))
    # Never two valid answers: the other one is always missing, unknown or out of range.
    fields.append(b"unknown" + str(chance.randrange(99)).encode() + b"=1")
    where = chance.choice(("answers", "answers/", "unplayable/x", "answers?x=%ff"))
    path = f"{chance.choice(known.pages)}/{where}".encode()
    return _request("POST", path, b"&".join(fields), chance, chance.choice(KINDS))


def _watched(known: Known, chance: random.Random) -> bytes:
    """Report playback that cannot have happened."""
    numbers: tuple[object, ...] = (-1, 1e300, "1", None, True, [], {}, 10**30, float("nan"))
    report: object = {
        "batch": chance.choice((*numbers, 0)),
        "intervals": chance.choice(
            (numbers, [[0]], [[0, 1, 2]], [[5, None]], [["a", "b"]], "x", [[0, 1]] * 300, None)
        ),
        chance.choice(("extra", "rate", "frames", "\u0000")): chance.choice(numbers),
    }
    body = json.dumps(report).encode()
    damage = chance.randrange(5)
    if damage == 0:
        body = body[: chance.randrange(len(body))]
    elif damage == 1:
        body = b"[" * chance.choice((10, 60_000))
    elif damage == 2:
        body = chance.choice(TEXTS)
    elif damage == 3:
        body = b'{"batch": 0, "intervals": [[0, 1]]}' + b" " * 70_000
    path = f"{chance.choice(known.pages)}/watched/{chance.choice((*known.videos, 'nobody'))}"
    return _request("POST", path.encode(), body, chance, chance.choice(KINDS))


def _form(known: Known, chance: random.Random) -> bytes:
    """Send a form that is not due."""
    stage = chance.choice(("demographics", "closing", "consent", "eligibility", "%00"))
    path = f"{chance.choice(known.pages)}/form/{stage}".encode()
    fields = b"&".join(b"form:" + text for text in _drawn(TEXTS, chance, 3))
    return _request("POST", path, fields, chance, chance.choice(KINDS))


def _media(known: Known, chance: random.Random) -> bytes:
    """Request a video in ways that a player does not."""
    token = chance.choice((*known.videos, "nobody", "..", "%00", "a" * 3000))
    end = chance.choice((".mp4", ".mp4/", ".mov", "", ".mp4%00", ".mp4?x=" + "y" * 4000))
    return _request(chance.choice(METHODS), f"/media/{token}{end}".encode(), b"", chance)


def _not_http(known: Known, chance: random.Random) -> bytes:
    """Send malformed HTTP."""
    return chance.choice(
        (
            b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
            chance.randbytes(chance.randrange(1, 400)) + b"\r\n\r\n",
            b"GET\r\n\r\n",
            b"GET  / HTTP/1.1\r\n\r\n",
            b"GET / HTTP/9.9\r\nHost: x\r\n\r\n",
            b"GET " + chance.choice(known.pages).encode() + b" \x00 HTTP/1.1\r\n\r\n",
            b"GET /" + b"a" * 20_000 + b" HTTP/1.1\r\n\r\n",
            b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 500 + b"\r\n",
            b"POST / HTTP/1.1\r\nContent-Length: -5\r\n\r\n",
            b"POST / HTTP/1.1\r\nContent-Length: 5\r\nContent-Length: 6\r\n\r\nabcde",
            b"POST / HTTP/1.1\r\nContent-Length: ten\r\n\r\n",
            b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nZZ\r\n",
            b"POST / HTTP/1.1\r\nTransfer-Encoding: xyz\r\n\r\n",
            b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        )
    )


def _request(
    method: str, path: bytes, body: bytes, chance: random.Random, kind: str = KINDS[0]
) -> bytes:
    """Return a request with some headers that do not belong there."""
    if chance.random() < 0.7:
        path = quote_from_bytes(path, safe="/?=&%:").encode()
    path = path.replace(b" ", b"%20").replace(b"\r", b"%0d").replace(b"\n", b"%0a") or b"/"
    lines = [method.encode() + b" " + path + b" HTTP/1.1", b"Host: study.example"]
    if body or method == "POST":
        lines.append(b"Content-Type: " + kind.encode("latin-1"))
        lines.append(b"Content-Length: " + str(len(body)).encode())
    if chance.random() < 0.4:
        lines.append(chance.choice(HEADERS))
    lines.append(b"Connection: close")
    return b"\r\n".join((*lines, b"", b"")) + body


def _drawn(texts: Sequence[bytes], chance: random.Random, count: int) -> list[bytes]:
    return [chance.choice(texts) for _ in range(count)]
