"""Fours of windows that tell content, emotion and style of speech apart.

Chhatre et al. 2024, appendix B.4: two texts, each spoken by two speakers, all in one emotion.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from training.data.beat_names import BeatName
from training.data.windows import Windows


def quadruples(windows: Windows, *, most: int, seed: int) -> NDArray[np.int64]:
    """Return rows of windows.

    The columns are (c1, s1), (c2, s1), (c1, s2), (c2, s2); the four windows of a row are equally
    far from the beginning of their recordings.

    Parameters
    ----------
    windows : Windows
        Whose takes have BEAT's names, which tell the text.
    most : int
        Where there are more, so many are drawn.
    seed : int
        Of the draw.

    Returns
    -------
    ndarray, shape (quadruples, 4)
        None where no two speakers speak two texts in one emotion.
    """
    found = [
        four
        for emotion, texts in _by_emotion(windows).items()
        for first, second in combinations(sorted(texts), 2)
        for one, other in combinations(sorted(set(texts[first]) & set(texts[second])), 2)
        for four in zip(
            texts[first][one], texts[second][one], texts[first][other], texts[second][other],
            strict=False,
        )
        if emotion
    ]  # fmt: skip
    rows = np.array(found, dtype=np.int64).reshape(-1, 4)
    if len(rows) <= most:
        return rows
    return rows[np.sort(np.random.default_rng(seed).choice(len(rows), most, replace=False))]


def _by_emotion(windows: Windows) -> dict[str, dict[str, dict[str, list[int]]]]:
    """Return the rows of windows by emotion, by text, by speaker."""
    rows: dict[str, dict[str, dict[str, list[int]]]] = {}
    for row in range(len(windows)):
        take = windows.take_of(row)
        name = BeatName.parse(take.name)
        if name is not None:
            text = f"{name.start:04}-{name.end:04}"
            speakers = rows.setdefault(take.emotion, {}).setdefault(text, {})
            speakers.setdefault(take.speaker, []).append(row)
    return rows
