"""Gesture emotion accuracy (GA): how often a network names the emotion that was spoken.

AMUSE (Chhatre et al. 2024, section 5.1) reports the top-1 accuracy of a classifier of gestures, as
the mean over emotions, with a confusion matrix (its figure A.11). Recorded gestures are not
classified without error either, so their accuracy is reported as another condition.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from analysis.metrics.scores import EmotionConfusion, Metric, MetricResult


def emotion_confusion(
    spoken: Sequence[str],
    named: Sequence[str],
    labels: Sequence[str],
    *,
    condition: str,
    network: str,
) -> EmotionConfusion:
    """Count the emotions that the network named, by spoken emotion.

    Parameters
    ----------
    spoken, named : sequence of str
        The emotion of each clip's speech, and the emotion that the network named.
    labels : sequence of str
        The emotions that the network classifies. Clips with other emotions are left out.
    condition, network : str
        The condition, and the hash of the network.
    """
    counts = np.zeros((len(labels), len(labels)), int)
    index = {label: number for number, label in enumerate(labels)}
    for truth, answer in zip(spoken, named, strict=True):
        if truth in index:
            counts[index[truth], index[answer]] += 1
    spoken_rows = [row for row in range(len(labels)) if counts[row].any()]
    return EmotionConfusion(
        condition=condition,
        network=network,
        spoken=tuple(labels[number] for number in spoken_rows),
        named=tuple(labels),
        counts=tuple(tuple(int(count) for count in row) for row in counts[spoken_rows]),
    )


def emotion_accuracy(
    confusion: EmotionConfusion, *, name: str, settings: Mapping[str, str]
) -> MetricResult:
    """Return the share of clips whose spoken emotion is named, as the mean over emotions.

    Parameters
    ----------
    confusion : EmotionConfusion
        The confusion.
    name : str
        Names the metric.
    settings : mapping
        The network and its settings.

    Returns
    -------
    MetricResult
        In [0, 1]; every emotion has the same weight, however many clips it has. NaN if no clip has
        an emotion that the network knows.
    """
    counts = np.array(confusion.counts, float).reshape(len(confusion.spoken), len(confusion.named))
    clips = counts.sum(axis=1)
    metric = Metric(name, better="higher")
    description = dict(settings) | {
        "mean over": ", ".join(
            f"{emotion} ({int(count)})"
            for emotion, count in zip(confusion.spoken, clips, strict=True)
        ),
        "chance": f"1 / {len(confusion.named)}",
    }
    if not len(clips):
        reason = "no clip has speech of an emotion that the network knows"
        return metric.missing(reason, description)
    right = counts[np.arange(len(clips)), [confusion.named.index(e) for e in confusion.spoken]]
    return metric.score(float((right / clips).mean()), int(clips.sum()), description)
