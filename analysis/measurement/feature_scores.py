"""Scores of whole conditions in the features of one network: distances, variance, emotions."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from analysis.evaluators import feature_networks as names
from analysis.evaluators.feature_networks import ClipFeatures, Network
from analysis.metrics.diversity import feature_variance
from analysis.metrics.embeddings import Embeddings, drawn, embeddings
from analysis.metrics.emotion_accuracy import emotion_accuracy, emotion_confusion
from analysis.metrics.frechet import (
    FAILED,
    RULES,
    Rule,
    frechet,
    frechet_extrapolated,
    published_distance,
)
from analysis.metrics.kernel_distance import kernel_distance
from analysis.metrics.scores import (
    Better,
    ClipScore,
    ConditionScore,
    EmotionConfusion,
    Metric,
    MetricResult,
    counted,
    whole_condition,
)

ENOUGH: Final = 0.5
"""A condition with fewer windows than this share of the most gets no Fréchet distance: cutting all
others to its size would cost them their precision."""

Clips = Mapping[str, ClipFeatures]
"""Features by segment."""


@dataclass(frozen=True, kw_only=True)
class FeatureScores:
    """The scores of all conditions in one network's features.

    Attributes
    ----------
    clips : tuple of ClipScore
        Whether the network named the emotion of each clip.
    conditions : tuple of ConditionScore
        By condition.
    confusions : tuple of EmotionConfusion
        By condition; empty for a network without labels.
    """

    clips: tuple[ClipScore, ...] = ()
    conditions: tuple[ConditionScore, ...] = ()
    confusions: tuple[EmotionConfusion, ...] = ()


def feature_scores(
    network: Network,
    conditions: Mapping[str, Clips],
    recorded: Clips,
    *,
    recordings: frozenset[str] = frozenset(),
    emotions: Mapping[str, str] | None = None,
) -> FeatureScores:
    """Score all conditions in the features of one network.

    Parameters
    ----------
    network : Network
        The network.
    conditions : mapping of condition to mapping of segment to ClipFeatures
        All clips.
    recorded : mapping of segment to ClipFeatures
        Features of recorded motion; without them there are no distances.
    recordings : frozenset of str
        Conditions that are recorded motion, which have no distance from themselves.
    emotions : mapping of segment to str, optional
        The emotion of each segment's speech.
    """
    samples = {condition: _sample(clips) for condition, clips in conditions.items()}
    reference = _sample(recorded)
    compared = {
        condition: sample for condition, sample in samples.items() if condition not in recordings
    }
    shared = _shared_count([*map(len, compared.values()), len(reference)])
    by_clip: list[ClipScore] = []
    by_condition: list[ConditionScore] = []
    confusions = []
    for condition, clips in conditions.items():
        results: list[MetricResult] = []
        if condition in compared:
            results += _distances(network, compared[condition], reference, shared)
        results.append(
            feature_variance(
                samples[condition].values,
                name=f"variance of features ({network.name})",
                settings=network.settings,
            )
        )
        if network.labels:
            named, confusion = _emotions(network, condition, clips, emotions or {})
            by_clip += named
            confusions.append(confusion)
            results.append(
                emotion_accuracy(
                    confusion,
                    name=f"gesture emotion accuracy ({network.name})",
                    settings=network.settings,
                )
            )
        left_out = [clip.reason for clip in clips.values() if clip.reason]
        for result in results:
            score = whole_condition(condition, result, len(clips))
            by_condition.append(_with_left_out(score, left_out))
    return FeatureScores(
        clips=tuple(by_clip), conditions=tuple(by_condition), confusions=tuple(confusions)
    )


def scores_without_network(
    name: str, command: str, condition: str, clips: int, *, recorded: bool
) -> Iterator[ConditionScore]:
    """Yield the scores of a network that is missing, with the command that trains it.

    Parameters
    ----------
    name : str
        The network's name in `analysis.evaluators.feature_networks`.
    command : str
        The command that trains one.
    condition, clips : str, int
        The condition, and how many clips it has.
    recorded : bool
        Whether the clips are recorded motion, which has no distance from itself.
    """
    missing: list[tuple[str, Better]] = [] if recorded else [(names.DISTANCES[name], "lower")]
    if name == names.EMOTION:
        missing += [
            (names.VARIANCE_OF_EMOTION, "near the reference"),
            (names.EMOTION_ACCURACY, "higher"),
        ]
    reason = f"no {name} is given; '{command}' trains one"
    for metric, better in missing:
        yield whole_condition(condition, Metric(metric, better=better).missing(reason), clips)


def _sample(clips: Clips) -> Embeddings:
    """Return all windows of all clips, in the order of the segments."""
    usable = [(segment, clips[segment]) for segment in sorted(clips) if not clips[segment].reason]
    usable = [(segment, clip) for segment, clip in usable if clip.features.size]
    if not usable:
        return Embeddings(values=np.zeros((0, 1)), clips=np.zeros(0, np.int64))
    values = np.vstack([clip.features for _, clip in usable]).astype(np.float64)
    return embeddings(values, [segment for segment, clip in usable for _ in clip.features])


def _shared_count(counts: Sequence[int]) -> int:
    """Return the number of windows of each condition in a Fréchet distance."""
    most = max(counts, default=0)
    return min((count for count in counts if count >= ENOUGH * most), default=0)


def _distances(
    network: Network, generated: Embeddings, reference: Embeddings, shared: int
) -> Iterator[MetricResult]:
    """Yield Fréchet distance, FGD∞ and kernel distance from recorded motion."""
    distance = names.distance_of(network.name)
    metrics = [distance, names.extrapolated(distance), names.kernel_of(network.name)]
    if network.rule:
        metrics.append(names.as_published(distance))
    reason = ""
    if not len(reference):
        reason = "there is no recorded motion to compare with"
    elif not len(generated):
        reason = "the network can look at none of the clips"
    if reason:
        for name in metrics:
            yield _missing(name, reason, network)
        return
    count = min(shared, len(generated), len(reference))
    if count < shared:
        yield _missing(
            distance,
            f"{count} windows are fewer than half of what others have, so no distance of equal "
            "size compares them",
            network,
        )
    else:
        settings = dict(network.settings) | {
            "samples": f"{count} windows of recorded motion and of every condition"
        }
        samples = drawn(generated, count), drawn(reference, count)
        result = frechet(*samples, name=distance, settings=settings)
        yield replace(result, settings={**result.settings, **settings})
    yield frechet_extrapolated(
        generated, reference, name=names.extrapolated(distance), settings=network.settings
    )
    yield kernel_distance(
        generated, reference, name=names.kernel_of(network.name), settings=network.settings
    )
    if network.rule:
        name = names.as_published(distance)
        yield _by_published_rule(network, generated, reference, network.rule, name)


def _by_published_rule(
    network: Network, generated: Embeddings, reference: Embeddings, rule: Rule, name: str
) -> MetricResult:
    """Return the Fréchet distance over all windows, as the network's authors' code computes it."""
    fewest, dimensions = min(len(generated), len(reference)), reference.values.shape[1]
    settings = dict(network.settings) | {
        "samples": f"{len(generated)} generated, {len(reference)} recorded",
        "dimensions": f"{dimensions}",
        "covariance": RULES[rule],
    }
    if fewest < 2:
        return _missing(name, "a covariance needs two samples", network)
    remark = ""
    if fewest <= dimensions:
        remark = (
            f"{fewest} samples do not fill {dimensions} dimensions: the published rule takes the "
            "root of a singular product, whose value depends on library versions and threads, and "
            f"which may end as {FAILED:.0e}"
        )
    value = published_distance(generated.values, reference.values, rule)
    return Metric(name, better="lower").score(value, fewest, settings, remark=remark)


def _missing(name: str, reason: str, network: Network) -> MetricResult:
    return Metric(name, better="lower").missing(reason, network.settings)


def _emotions(
    network: Network, condition: str, clips: Clips, emotions: Mapping[str, str]
) -> tuple[list[ClipScore], EmotionConfusion]:
    """Return whether each clip's emotion was named, and the confusion of all clips."""
    metric = Metric(f"spoken emotion named ({network.name})", better="higher")
    spoken, named, scores = [], [], []
    for segment in sorted(clips):
        index, emotion = clips[segment].named_emotion, emotions.get(segment, "")
        if index is None or emotion not in network.labels:
            continue
        answer = network.labels[index]
        spoken.append(emotion)
        named.append(answer)
        result = metric.score(
            float(answer == emotion),
            len(clips[segment].emotions),
            network.settings,
            remark=f"spoken: {emotion}, named: {answer}",
        )
        scores.append(ClipScore(condition=condition, segment=segment, result=result))
    confusion = emotion_confusion(
        spoken, named, network.labels, condition=condition, network=network.sha256
    )
    return scores, confusion


def _with_left_out(score: ConditionScore, left_out: Sequence[str]) -> ConditionScore:
    """Return the score with the number of clips left out, and why."""
    if not left_out:
        return score
    why = counted(left_out, score.clips)
    scored = max(0, score.scored - len(left_out))
    if score.reason:
        return replace(score, scored=scored, reason=f"{score.reason}: {why}")
    remark = "; ".join(part for part in (score.remark, f"left out: {why}") if part)
    return replace(score, scored=scored, remark=remark)
