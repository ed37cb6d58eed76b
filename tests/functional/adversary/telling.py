"""Everything a browser received of a trial as numbers and words that somebody could guess from."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from itertools import pairwise
from typing import Final

from tests.functional.adversary.listening import Exchange, HeardTrial
from tests.functional.adversary.mp4_facts import Facts, facts_of

TOKEN: Final = re.compile(r"(?<![\w-])[\w-]{32}(?![\w-])", re.ASCII)
NUMBER: Final = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?![\w.])")
WORD: Final = re.compile(r"\w[\w:.-]*|[^\w\s]")
QUESTION: Final = re.compile(r"<legend>.*?</legend>", re.DOTALL)
"""The words of a question: those of an attention check say by their nature what it is."""


def trial_facts(trial: HeardTrial, *, questions: bool) -> Facts:
    """Return what was received of a whole trial, its videos' under their labels.

    Parameters
    ----------
    questions : bool
        Whether the words of the questions are read too.
    """
    facts = page_facts(trial, questions=questions)
    for place, exchanges in enumerate(trial.videos.values(), start=1):
        facts |= _named(f"video {place}", _told(exchanges))
    return facts


def page_facts(trial: HeardTrial, *, questions: bool) -> Facts:
    """Return what was received of a trial beside its videos."""
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


def stimulus_facts(trial: HeardTrial, *, questions: bool) -> dict[int, Facts]:
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
    """Return what was received of the video `own`, one of `videos`."""
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
