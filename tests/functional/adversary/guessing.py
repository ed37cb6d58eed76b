"""Guesses of hidden truths, and a test whether they are better than chance.

Half of the study sessions are learnt from, with the truth given; the other half is guessed. If
nothing leaks, what is true of one study session could as well be true of any other of the same
outward shape: the truths of the guessed half are exchanged among such study sessions, many times,
and the guesses are compared with each. That test is exact, whatever the guesser does and however
the design ties the trials of a study session to each other.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import RandomForestClassifier
from sklearn.feature_extraction import DictVectorizer
from sklearn.linear_model import LogisticRegression
from sklearn.neighbors import KNeighborsClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from tests.functional.adversary.facts import Facts

EXCHANGES: Final = 19_999
"""How often truths are exchanged; the smallest p is one in one more."""

MOST_FACTS: Final = 60
"""How many facts are guessed from: those most informative about the training truths."""

SAME: Final = 1e-9
"""Numbers no further apart are the same but for rounding."""

LEAST: Final = 0.01
"""The smallest probability given to what a guesser considers impossible."""


@dataclass(frozen=True)
class Received:
    """One study session to learn from, or to guess.

    Attributes
    ----------
    rows : sequence of Facts
        What was received, item by item.
    truth : sequence of str
        What is true of each item.
    shape : hashable
        What may be known of the study session without any leak.
    """

    rows: Sequence[Facts]
    truth: Sequence[str]
    shape: Hashable


@dataclass(frozen=True)
class Guess:
    """How well one half was guessed.

    Attributes
    ----------
    p : float
        Probability of guesses as good as these if nothing leaks.
    right : float
        Share of items that were guessed right.
    told : tuple of str
        The most informative facts in training.
    """

    p: float
    right: float
    told: tuple[str, ...]


def guessers() -> list[Any]:
    """Return guessers of different kinds; they guess together, by the mean of their chances."""
    return [
        RandomForestClassifier(
            n_estimators=50, min_samples_leaf=2, max_features=0.3, random_state=0, n_jobs=1
        ),
        make_pipeline(StandardScaler(), LogisticRegression(C=0.1, max_iter=1000)),
        make_pipeline(StandardScaler(), KNeighborsClassifier(5)),
    ]


def guesses(sessions: Sequence[Received]) -> list[Guess]:
    """Learn from each half of `sessions` and guess the other.

    All of them must have equally many items.
    """
    names = DictVectorizer(sparse=False)
    rows = names.fit_transform(_unlike([row for session in sessions for row in session.rows]))
    facts = rows.reshape(len(sessions), -1, rows.shape[1])
    halves = np.arange(0, len(sessions), 2), np.arange(1, len(sessions), 2)
    return [
        _guess_half(
            facts[learnt],
            [sessions[int(index)] for index in learnt],
            facts[asked],
            [sessions[int(index)] for index in asked],
            names.feature_names_,
        )
        for learnt, asked in (halves, halves[::-1])
    ]


def _unlike(rows: Sequence[Facts]) -> list[Facts]:
    """Return `rows` without the facts that are the same in all of them."""
    alike = set(rows[0].items())
    for row in rows:
        alike = alike & row.items()
    return [dict(row.items() - alike) for row in rows]


def _guess_half(
    facts: NDArray[np.float64],
    learnt: Sequence[Received],
    facts_asked: NDArray[np.float64],
    asked: Sequence[Received],
    names: Sequence[str],
) -> Guess:
    truths = np.array([truth for session in learnt for truth in session.truth])
    # Facts that all study sessions share carry no information.
    usual = facts.mean(axis=0)
    known = (facts - usual).reshape(len(truths), -1)
    telling = _telling(known, truths)
    given = (facts_asked - usual)[:, :, telling].reshape(-1, len(telling))
    fitted = [guesser.fit(known[:, telling], truths) for guesser in guessers()]
    chances = np.mean([guesser.predict_proba(given) for guesser in fitted], axis=0)
    kinds = fitted[0].classes_
    guessed = kinds[chances.argmax(axis=1)]
    right = guessed == [truth for session in asked for truth in session.truth]
    logs = np.log(np.maximum(chances, LEAST)).reshape(len(asked), -1, len(kinds))
    return Guess(
        p=_p(list(logs), asked, {truth: column for column, truth in enumerate(kinds)}),
        right=float(right.mean()),
        told=tuple(str(names[column]) for column in telling[:5]),
    )


def _telling(known: NDArray[np.float64], truths: NDArray[Any]) -> NDArray[np.intp]:
    """Return the columns of `known` that differ most between truths, most informative first.

    Most differs what varies between truths and hardly within one (an analysis of variance). Of
    columns that say the same, one is taken.
    """
    varying = np.flatnonzero(np.ptp(known, axis=0) > SAME)
    scaled = StandardScaler().fit_transform(known[:, varying])
    _, first = np.unique(np.round(scaled, 6), axis=1, return_index=True)
    varying, scaled = varying[first], scaled[:, first]
    within = np.zeros(len(varying))
    for truth in np.unique(truths):
        alike = scaled[truths == truth]
        within += ((alike - alike.mean(axis=0)) ** 2).sum(axis=0)
    return varying[np.argsort(within, kind="stable")[:MOST_FACTS]]


def _p(
    logs: Sequence[NDArray[np.float64]], asked: Sequence[Received], classes: dict[str, int]
) -> float:
    """Return the probability that exchanged truths fit the guesses as well as the real ones."""
    chance = np.random.default_rng(0)
    alike: defaultdict[Hashable, list[int]] = defaultdict(list)
    for index, session in enumerate(asked):
        alike[session.shape].append(index)
    real, exchanged = 0.0, np.zeros(EXCHANGES)
    for group in alike.values():
        fits = np.array([[_fit(logs[i], asked[j].truth, classes) for j in group] for i in group])
        order = chance.permuted(np.tile(np.arange(len(group)), (EXCHANGES, 1)), axis=1)
        real += np.trace(fits)
        exchanged += fits[np.arange(len(group)), order].sum(axis=1)
    return float((1 + np.count_nonzero(exchanged >= real - 1e-9)) / (1 + EXCHANGES))


def _fit(logs: NDArray[np.float64], truth: Sequence[str], classes: dict[str, int]) -> float:
    return float(
        sum(
            row[classes[true]] if true in classes else np.log(LEAST)
            for row, true in zip(logs, truth, strict=True)
        )
    )
