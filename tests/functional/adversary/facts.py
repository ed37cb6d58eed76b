"""Everything a browser received in a trial, as numbers and words to guess from."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import pairwise
from typing import Final

from tests.functional.adversary.recording import Exchange, RecordedTrial

Facts = dict[str, float | str]
"""Numbers by name, and texts that are only compared for equality."""

HOLDERS: Final = {"moov", "trak", "mdia", "minf", "stbl", "edts", "dinf", "udta"}
"""Boxes that hold nothing but boxes (ISO/IEC 14496-12)."""

COUNTED: Final = {"stsz": 12, "stco": 8}
"""Tables with the size and position of each encoded picture and each piece of sound. They follow
from what is seen and heard; their number does not, and precedes them."""

SHORT: Final = 256
"""Bytes of a box whose content is also read as numbers."""

WRITTEN: Final = re.compile(rb"[\x20-\x7e]{16,}")
"""What somebody wrote into a file; encoded pictures hold so long a run by chance but rarely."""

TOKEN: Final = re.compile(r"(?<![\w-])[\w-]{32}(?![\w-])", re.ASCII)
NUMBER: Final = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?![\w.])")
WORD: Final = re.compile(r"\w[\w:.-]*|[^\w\s]")
QUESTION: Final = re.compile(r"<legend>.*?</legend>", re.DOTALL)
"""The words of a question: those of an attention check say by their nature what it is."""


def trial_facts(trial: RecordedTrial, *, questions: bool) -> Facts:
    """Return the facts of a whole trial, those of its videos under their labels.

    Parameters
    ----------
    questions : bool
        Whether the words of the questions are read too.
    """
    facts = page_facts(trial, questions=questions)
    for place, exchanges in enumerate(trial.videos.values(), start=1):
        facts |= _named(f"video {place}", _told(exchanges))
    return facts


def page_facts(trial: RecordedTrial, *, questions: bool) -> Facts:
    """Return the facts of a trial except its videos."""
    facts: Facts = {}
    seen: Counter[str] = Counter()
    for exchange in trial.pages:
        seen[exchange.name] += 1
        body = exchange.body.decode("utf-8") if exchange.name != "ahead" else ""
        if not questions:
            body = QUESTION.sub("", body)
        own = _headers(exchange)
        own |= _text(body) if exchange.name != "ahead" else _video(exchange)
        if not questions:  # nor how long a page with these words is
            own = {name: told for name, told in own.items() if "Content-Length" not in name}
        facts |= _named(f"{exchange.name} {seen[exchange.name]}", own)
    return facts


def stimulus_facts(trial: RecordedTrial, *, questions: bool) -> dict[int, Facts]:
    """Return what was received of each stimulus: its video, beside the others, and the page.

    Parameters
    ----------
    questions : bool
        Whether the words of the questions are read too.

    Returns
    -------
    dict of int to dict
        By the stimulus' number, 1 for A.
    """
    page = page_facts(trial, questions=questions)
    videos = {label: _told(exchanges) for label, exchanges in trial.videos.items()}
    return {
        number: page | _own_facts(videos[label], list(videos.values()), number)
        for label, shown in trial.numbers.items()
        for number in shown
    }


def _own_facts(own: Facts, videos: list[Facts], number: int) -> Facts:
    """Return the facts of the video `own`, one of `videos`."""
    facts = _named("own", own)
    facts["number"] = number
    for name, value in own.items():
        if isinstance(value, int | float):
            among = [told.get(name, 0.0) for told in videos]
            numbers = [float(told) for told in among if not isinstance(told, str)]
            facts[f"own {name} above the mean"] = round(value - sum(numbers) / len(numbers), 6)
    return facts


def _told(exchanges: Iterable[Exchange]) -> Facts:
    facts: Facts = {}
    for exchange in exchanges:
        own = _headers(exchange)
        if exchange.name == "whole":
            own |= _video(exchange)
        elif exchange.name == "watched":
            own |= _text(exchange.body.decode("utf-8"))
        facts |= _named(exchange.name, own)
    return facts


def _video(exchange: Exchange) -> Facts:
    return {"bytes": len(exchange.body), **facts_of(exchange.body)}


def _named(prefix: str, facts: Facts) -> Facts:
    return {f"{prefix}: {name}": value for name, value in facts.items()}


def _headers(exchange: Exchange) -> Facts:
    facts: Facts = {
        "status": exchange.status,
        "bytes": len(exchange.body) if exchange.status >= 400 else 0,
        "headers": " ".join(name for name, _ in exchange.headers),
    }
    for name, value in exchange.headers:
        facts[name] = TOKEN.sub("TOKEN", value)
        for place, number in enumerate(NUMBER.findall(value)):
            facts[f"{name} number {place}"] = float(number)
    return facts


def _text(text: str) -> Facts:
    """Return the words of a text and which follow which, its numbers in order, and its tokens."""
    facts: Facts = {"length": len(text), "lines": text.count("\n")}
    for place, number in enumerate(NUMBER.findall(text)):
        facts[f"number {place}"] = float(number)
    tokens = list(dict.fromkeys(TOKEN.findall(text)))
    for place, token in enumerate(tokens):
        facts |= _named(f"token {place}", _token(token, tokens))
    words = WORD.findall(TOKEN.sub("TOKEN", text))
    counts = Counter(words) + Counter(map(" ".join, pairwise(words)))
    facts |= {f"word {word}": count for word, count in counts.items()}
    return facts


def _token(token: str, others: list[str]) -> Facts:
    return {
        "begins at": ord(token[0]),
        "ends at": ord(token[-1]),
        "digits": sum(map(str.isdigit, token)),
        "capitals": sum(map(str.isupper, token)),
        "dashes": token.count("-") + token.count("_"),
        "place": sorted(others).index(token),
    }


@lru_cache(maxsize=4096)
def facts_of(video: bytes) -> Facts:
    """Return the facts in the boxes of `video`.

    Left out is what follows from the encoded pictures and sound alone: these themselves, the
    bytes each of them has, and the padding that makes up for their sum.
    """
    facts: Facts = {}
    counts: Counter[str] = Counter()
    for name, content in _boxes(video, 0, len(video), ""):
        counts[name] += 1
        key = f"{name}{counts[name]}"
        if name in ("/mdat", "/free"):
            continue
        described = content[: COUNTED.get(name.rpartition("/")[2], len(content))]
        facts[f"{key} bytes"] = len(content)
        facts[f"{key} content"] = hashlib.sha256(described).hexdigest()
        if len(described) <= SHORT:
            for at in range(0, len(described) - 3, 4):
                facts[f"{key} at {at}"] = int.from_bytes(described[at : at + 4], "big")
    order = [name for name, _ in _boxes(video, 0, len(video), "")]
    facts["order"] = " ".join(order[:-1] if order[-1] == "/free" else order)
    for text in WRITTEN.findall(video):
        facts[f"text {text.decode()}"] = 1
    return facts


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
