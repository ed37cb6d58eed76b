"""Sums of answers, and how much each condition is preferred in bootstrap resamples of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.grouping import codes, shown_codes
from analysis.results.net_preference import sided
from analysis.stats.samples import Table, bootstrap_counts, table_of, weighted_row_sums

Floats = NDArray[np.float64]

Codes = NDArray[np.intp]

PREFERENCE: Final = {
    "pairwise": "Bradley–Terry strength in logits, ties counting one half, adding up to zero",
    "rating": "mean rating",
    "ranking": "minus the mean rank",
    "mismatch": "win share of the own speech, ties counting one half",
}
"""What stands for people's preference of a condition, by protocol."""

RESAMPLES: Final = 2_000

PSEUDO_VOTES: Final = 0.01
"""Votes for each side that every compared pair is given, so that strengths stay finite where one
side won always."""

_STEPS: Final = 100

_LONGEST_STEP: Final = 1.5

_CLOSE: Final = 1e-9

_BLOCK: Final = 4_000_000
"""Sums held at a time: bounds the memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tallies:
    """Answers to one question.

    Attributes
    ----------
    conditions, segments : tuple of str
        Those that were shown.
    groups : ndarray of int, shape (G, 1) or (G, 2)
        What an answer is about: a condition, or of pairwise comparisons a pair of them, of which
        the answer is a win of the first.
    sums, counts : array or sparse array, shape (participants, G * segments)
        Sum and number of answers; columns by group, then segment.
    """

    conditions: tuple[str, ...]
    segments: tuple[str, ...]
    groups: Codes
    sums: Table
    counts: Table

    @property
    def participants(self) -> int:
        """How many answered."""
        return int(self.counts.shape[0])

    @property
    def cells(self) -> tuple[Floats, Floats]:
        """Sums and counts over all participants, shape (G, segments)."""
        shape = (len(self.groups), len(self.segments))
        sums, counts = (
            np.asarray(table.sum(axis=0), np.float64).reshape(shape)
            for table in (self.sums, self.counts)
        )
        return sums, counts


def tally(protocol: str, answers: pd.DataFrame) -> Tallies:
    """Sum up the answers to one question.

    Parameters
    ----------
    protocol : {'pairwise', 'rating', 'ranking', 'mismatch'}
        How they were asked for.
    answers : DataFrame
        Analysed answers of `analysis.answers.table.AnswerTable`, at least one.
    """
    values = _values(protocol, answers)
    names = answers["left" if protocol == "pairwise" else "condition"].cat.categories
    shown = np.stack(list(shown_codes(answers).values()), axis=1)
    present, conditions = np.unique(shown, return_inverse=True)
    groups, group = np.unique(conditions.reshape(shown.shape), axis=0, return_inverse=True)
    participants, rows = np.unique(codes(answers, "participant"), return_inverse=True)
    segments, segment = np.unique(codes(answers, "segment"), return_inverse=True)
    columns = group.ravel() * len(segments) + segment
    shape = (len(participants), len(groups) * len(segments))
    return Tallies(
        conditions=tuple(map(str, names[present])),
        segments=tuple(map(str, answers["segment"].cat.categories[segments])),
        groups=groups.astype(np.intp),
        sums=table_of(values, rows, columns, shape),
        counts=table_of(np.ones(len(values)), rows, columns, shape),
    )


def _values(protocol: str, answers: pd.DataFrame) -> Floats:
    """Return each answer as a number that is higher the more is preferred what it is about."""
    if protocol in ("pairwise", "mismatch"):
        return sided(answers).wins
    if protocol == "ranking":
        return -_ranks(answers)
    return answers["value"].to_numpy(np.float64)


def _ranks(answers: pd.DataFrame) -> Floats:
    """Return the rank of each placed condition in its ranking, ties sharing theirs."""
    rankings = [codes(answers, "participant"), codes(answers, "segment")]
    ranks = pd.Series(answers["value"].to_numpy(np.float64))
    return ranks.groupby(rankings).rank(method="average").to_numpy(np.float64)


@dataclass(frozen=True, kw_only=True, eq=False)
class ResampledPreferences:
    """Preferences of all conditions.

    Attributes
    ----------
    estimates : ndarray, shape (conditions,)
        In the study; NaN where conditions cannot be compared with each other.
    draws : ndarray, shape (B, conditions)
        In each resample; NaN where a condition was not drawn.
    segments : ndarray, shape (B, segments)
        How often each resample draws each segment.
    """

    estimates: Floats
    draws: Floats
    segments: Floats


def resample_preferences(tallies: Tallies, *, resamples: int, seed: int) -> ResampledPreferences:
    """Resample participants and segments together, and score the conditions each time.

    An answer counts as often as its participant and its segment were drawn together (the
    pigeonhole bootstrap of Owen 2007).

    Parameters
    ----------
    tallies : Tallies
        The answers.
    resamples : int
        How many studies to draw.
    seed : int
        The same seed gives the same resamples.
    """
    chance = np.random.default_rng(seed)
    sums, counts = tallies.cells
    scores, drawn_segments = [], []
    block = max(1, min(resamples, _BLOCK // max(counts.size, tallies.participants)))
    for start in range(0, resamples, block):
        size = min(block, resamples - start)
        participants = bootstrap_counts(chance, size, tallies.participants)
        segments = bootstrap_counts(chance, size, len(tallies.segments))
        resampled = [
            _resampled_sums(table, participants, segments, counts.shape)
            for table in (tallies.sums, tallies.counts)
        ]
        scores.append(_scores(tallies, *resampled))
        drawn_segments.append(segments)
    return ResampledPreferences(
        estimates=_scores(tallies, sums.sum(axis=1)[None], counts.sum(axis=1)[None])[0],
        draws=np.concatenate(scores),
        segments=np.concatenate(drawn_segments),
    )


def _resampled_sums(
    table: Table, participants: Floats, segments: Floats, shape: tuple[int, ...]
) -> Floats:
    """Return the sum of each group over drawn participants and segments, shape (B, G)."""
    by_cell = weighted_row_sums(table, participants).reshape(-1, *shape)
    return np.asarray(np.einsum("bgi,bi->bg", by_cell, segments))


def _scores(tallies: Tallies, sums: Floats, counts: Floats) -> Floats:
    """Return the preference of each condition from sums and counts by group, shape (B, G)."""
    if tallies.groups.shape[1] == 1:
        with np.errstate(invalid="ignore", divide="ignore"):
            return sums / counts
    first, second = tallies.groups.T
    size = len(tallies.conditions)
    wins = np.zeros((len(sums), size, size))
    wins[:, first, second] = sums
    wins[:, second, first] = counts - sums
    return fit_strengths_of_tables(wins)


def fit_strengths_of_tables(wins: Floats) -> Floats:
    """Fit a Bradley-Terry model, ties counting one half, to each of many tables of wins.

    Parameters
    ----------
    wins : ndarray, shape (B, k, k)
        How often the condition of the row was preferred to that of the column, with half of the
        ties.

    Returns
    -------
    ndarray, shape (B, k)
        Log strengths that add up to zero; NaN where the compared pairs do not connect all
        conditions, so that some cannot be compared with others.
    """
    count = wins.shape[-1]
    compared = (wins + wins.swapaxes(1, 2)) > 0
    usable = _connected(compared)
    won = wins[usable] + PSEUDO_VOTES * compared[usable]
    votes = won + won.swapaxes(1, 2)
    strengths = np.zeros((len(won), count))
    # Adding a constant to all strengths changes nothing: this fixes their mean.
    fixed = np.full((count, count), 1 / count)
    for _ in range(_STEPS):
        chance = 1 / (1 + np.exp(strengths[:, None, :] - strengths[:, :, None]))
        gradient = (won - votes * chance).sum(axis=2)
        weights = votes * chance * (1 - chance)
        information = -weights
        information[:, np.arange(count), np.arange(count)] = weights.sum(axis=2)
        step = np.linalg.solve(information + fixed, gradient[..., None])[..., 0]
        longest = np.abs(step).max(axis=1, keepdims=True, initial=0)
        step *= np.minimum(1, _LONGEST_STEP / np.maximum(longest, _CLOSE))
        strengths += step
        if np.abs(step).max(initial=0) < _CLOSE:
            break
    centred = np.full(wins.shape[:2], np.nan)
    centred[usable] = strengths - strengths.mean(axis=1, keepdims=True)
    return centred


def _connected(compared: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which of the graphs, shape (B, k, k), are in one piece."""
    count = compared.shape[-1]
    reached = compared | np.eye(count, dtype=bool)
    for _ in range(max(1, count - 1).bit_length()):
        reached = np.matmul(reached.astype(np.float32), reached.astype(np.float32)) > 0
    return np.asarray(reached.all(axis=(1, 2)))
