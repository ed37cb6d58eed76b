"""People's preferences and a metric's scores of conditions, in bootstrap resamples of a study.

Scores are oriented: the higher, the better.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from scipy import sparse

from analysis.metrics.scores import Better, StudyMetrics
from analysis.results.grouping import codes, shown_codes
from analysis.results.mixed_models import sided
from analysis.results.strengths import RANKING
from analysis.stats.samples import bootstrap_counts
from analysis.stats.strength_models import fit_strengths_of_tables
from motion.arrays import Floats, Indices

PREFERENCE: Final = {
    "pairwise": "Bradley–Terry strength in logits, ties counting one half, adding up to zero",
    "rating": "mean rating",
    "ranking": "minus the mean rank",
    "mismatch": "win share of the own speech, ties counting one half",
}
"""The measure of people's preference for a condition, by protocol."""

RESAMPLES: Final = 2_000

FULL: Final = 0.05
"""Share of filled cells from which on a table is resampled without its indices."""

_BLOCK: Final = 4_000_000
"""Sums held at a time, which bounds the memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tallies:
    """Sums and counts of the answers to one question.

    Attributes
    ----------
    conditions, segments : tuple of str
        The conditions and segments that were shown.
    groups : ndarray of int, shape (G, 1) or (G, 2)
        The subjects of answers: a condition or, for pairwise comparisons, a pair; the answer is
        then a win of the first.
    sums, counts : sparse array, shape (participants, G * segments)
        Sum and number of answers; columns by group, then segment.
    """

    conditions: tuple[str, ...]
    segments: tuple[str, ...]
    groups: Indices
    sums: sparse.csr_array
    counts: sparse.csr_array

    @property
    def participants(self) -> int:
        """Number of participants."""
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
        The protocol of the answers.
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
        sums=sparse.csr_array((values, (rows, columns)), shape),
        counts=sparse.csr_array((np.ones(len(values)), (rows, columns)), shape),
    )


def _values(protocol: str, answers: pd.DataFrame) -> Floats:
    """Return each answer as a number that rises with the preference for its subject."""
    if protocol in ("pairwise", "mismatch"):
        return sided(answers).wins
    if protocol == "ranking":
        rankings = answers.groupby(RANKING, observed=True, dropna=False)["value"]
        return -rankings.rank().to_numpy(np.float64)
    return answers["value"].to_numpy(np.float64)


@dataclass(frozen=True, kw_only=True, eq=False)
class ResampledPreferences:
    """Preferences of all conditions.

    Attributes
    ----------
    estimates : ndarray, shape (conditions,)
        Preferences in the study; NaN if conditions cannot be compared with each other.
    draws : ndarray, shape (B, conditions)
        Preferences in each resample; NaN if a condition was not drawn.
    segments : ndarray, shape (B, segments)
        How often each resample draws each segment.
    """

    estimates: Floats
    draws: Floats
    segments: Floats


def resample_preferences(tallies: Tallies, *, resamples: int, seed: int) -> ResampledPreferences:
    """Resample participants and segments together, and score the conditions each time.

    An answer counts once for each time that its participant and its segment are drawn together (the
    pigeonhole bootstrap of Owen 2007).

    Parameters
    ----------
    tallies : Tallies
        The answers.
    resamples : int
        Number of studies to draw.
    seed : int
        The same seed gives the same resamples.
    """
    chance = np.random.default_rng(seed)
    sums, counts = tallies.cells
    tables = [_fastest(table) for table in (tallies.sums, tallies.counts)]
    scores, drawn_segments = [], []
    block = max(1, min(resamples, _BLOCK // max(counts.size, tallies.participants)))
    for start in range(0, resamples, block):
        size = min(block, resamples - start)
        participants = bootstrap_counts(chance, size, tallies.participants)
        segments = bootstrap_counts(chance, size, len(tallies.segments))
        resampled = [
            _resampled_sums(table, participants, segments, counts.shape) for table in tables
        ]
        scores.append(_scores(tallies, *resampled))
        drawn_segments.append(segments)
    return ResampledPreferences(
        estimates=_scores(tallies, sums.sum(axis=1)[None], counts.sum(axis=1)[None])[0],
        draws=np.concatenate(scores),
        segments=np.concatenate(drawn_segments),
    )


def _fastest(table: sparse.csr_array) -> Floats | sparse.csr_array:
    """Return `table` without indices if it is hardly sparse: then its products are faster."""
    is_full = table.nnz > FULL * table.shape[0] * table.shape[1]
    return np.asarray(table.toarray(), np.float64) if is_full else table


def _resampled_sums(
    table: Floats | sparse.csr_array,
    participants: Floats,
    segments: Floats,
    shape: tuple[int, ...],
) -> Floats:
    """Return the sum of each group over drawn participants and segments, shape (B, G)."""
    by_cell = np.asarray(participants @ table, np.float64).reshape(-1, *shape)
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


ITSELF = "the metric measures nearness to it"
NOT_MEASURED = "the metric was not measured"
NOTHING_RECORDED = "recorded motion, the reference of this metric, has no score"


@dataclass(frozen=True, kw_only=True, eq=False)
class OrientedMetric:
    """One metric of the judged conditions, whose scores can be oriented.

    Attributes
    ----------
    name, unit : str
        The metric's name and unit.
    better : {'lower', 'higher', 'near the reference'}
        Which scores are better.
    clips : ndarray, shape (conditions, segments), or None
        Score of each clip, NaN if it has none; None if only whole conditions have scores.
    whole : ndarray, shape (conditions,)
        Score of each condition; the mean over its clips if they have scores.
    recorded_clips, recorded : ndarray, shape (segments,), and float
        Scores of recorded motion if nearness to it counts; NaN otherwise.
    left_out : mapping of int to str
        Conditions without a usable score, and why.
    """

    name: str
    unit: str
    better: Better
    clips: Floats | None
    whole: Floats
    recorded_clips: Floats
    recorded: float
    left_out: Mapping[int, str]

    @property
    def present(self) -> Indices:
        """The conditions that have a score."""
        return np.array([c for c in range(len(self.whole)) if c not in self.left_out], np.intp)

    def orient(self, scores: Floats, recorded: Floats | float) -> Floats:
        """Return scores turned so that higher is better."""
        match self.better:
            case "higher":
                return scores
            case "lower":
                return -scores
            case _:
                return -np.abs(scores - recorded)

    def resampled(self, segments: Floats) -> Floats:
        """Return the oriented scores of the conditions that have one, in resamples of segments.

        Parameters
        ----------
        segments : ndarray, shape (B, segments)
            How often each segment was drawn.

        Returns
        -------
        ndarray, shape (B, present conditions)
            NaN if no clip with a score was drawn. Scores of whole conditions do not change.
        """
        if self.clips is None:
            oriented = self.orient(self.whole[self.present], self.recorded)
            return np.broadcast_to(oriented, (len(segments), len(oriented)))
        means = _drawn_means(self.clips[self.present], segments)
        recorded: Floats | float = math.nan
        if self.better == "near the reference":
            recorded = _drawn_means(self.recorded_clips[None], segments)
        return self.orient(means, recorded)


def oriented_metrics(
    metrics: StudyMetrics,
    conditions: Sequence[str],
    segments: Sequence[str],
    recorded: str | None,
) -> tuple[OrientedMetric, ...]:
    """Return every metric that has a better direction, in the order of its first score.

    Parameters
    ----------
    metrics : StudyMetrics
        The measured metrics.
    conditions, segments : sequence of str
        The conditions and segments that people judged.
    recorded : str or None
        The condition that is recorded motion.
    """
    by_clip: dict[str, dict[tuple[str, str], float]] = {}
    for clip in metrics.clips:
        by_clip.setdefault(clip.result.name, {})[clip.condition, clip.segment] = clip.result.value
    oriented: dict[str, OrientedMetric] = {}
    scores = {(score.name, score.condition): score for score in metrics.conditions}
    for score in metrics.conditions:
        if score.name in oriented or score.better == "unsaid":
            continue
        clip_values = by_clip.get(score.name)
        if clip_values is not None:
            clips = _table(clip_values, conditions, segments)
            recorded_clips = _table(clip_values, [recorded or ""], segments)[0]
            once = np.ones((1, len(segments)))
            [whole], [[reference]] = (
                _drawn_means(table, once) for table in (clips, recorded_clips[None])
            )
        else:
            clips, recorded_clips = None, np.full(len(segments), math.nan)
            values = {c: s.value for (name, c), s in scores.items() if name == score.name}
            whole = np.array([values.get(c, math.nan) for c in conditions])
            reference = values.get(recorded or "", math.nan)
        is_nearness = score.better == "near the reference"
        left_out = {}
        for number, condition in enumerate(conditions):
            if is_nearness and condition == recorded:
                left_out[number] = ITSELF
            elif is_nearness and math.isnan(reference):
                left_out[number] = NOTHING_RECORDED
            elif math.isnan(whole[number]):
                unscored = scores.get((score.name, condition))
                left_out[number] = (unscored.reason if unscored else "") or NOT_MEASURED
        oriented[score.name] = OrientedMetric(
            name=score.name,
            unit=score.unit,
            better=score.better,
            clips=clips,
            whole=whole,
            recorded_clips=recorded_clips,
            recorded=reference if is_nearness else math.nan,
            left_out=left_out,
        )
    return tuple(oriented.values())


def _table(
    values: Mapping[tuple[str, str], float], conditions: Sequence[str], segments: Sequence[str]
) -> Floats:
    return np.array([[values.get((c, s), math.nan) for s in segments] for c in conditions])


def _drawn_means(clips: Floats, segments: Floats) -> Floats:
    """Return means over drawn segments, shape (B, rows of clips)."""
    scored = ~np.isnan(clips)
    with np.errstate(invalid="ignore"):
        return np.asarray(
            segments @ np.where(scored, clips, 0).T / (segments @ scored.T.astype(np.float64))
        )
