"""Which recordings are kept back, to see how well a network does on what it never saw.

Windows of one recording resemble each other, so that a recording is kept back whole.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np


def held_out_recordings(
    recordings: Sequence[str], labels: Sequence[str], *, share: float, seed: int
) -> frozenset[str]:
    """Return the names of the recordings to keep back.

    Parameters
    ----------
    recordings : sequence of str
        The recording that each clip is from.
    labels : sequence of str
        The label of each clip; one and the same where there are none. Each label gives up its
        share, and keeps at least one recording to learn from.
    share : float
        Of the recordings of each label, above 0 and below 1; at least one where there are two.
    seed : int
        Not negative.

    Returns
    -------
    frozenset of str
        Empty where no label has two recordings.
    """
    of_recording: dict[str, Counter[str]] = {}
    for recording, label in zip(recordings, labels, strict=True):
        of_recording.setdefault(recording, Counter())[label] += 1
    by_label: dict[str, list[str]] = {}
    for recording in sorted(of_recording):
        counts = of_recording[recording]
        most = max(sorted(counts), key=lambda label: counts[label])
        by_label.setdefault(most, []).append(recording)
    chance = np.random.default_rng(seed)
    kept_back: list[str] = []
    for label in sorted(by_label):
        names = by_label[label]
        count = min(len(names) - 1, max(1, round(share * len(names))))
        drawn = chance.permutation(len(names))[: max(0, count)]
        kept_back += [names[index] for index in drawn]
    return frozenset(kept_back)
