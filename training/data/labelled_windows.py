"""Windows by what is said in them, in which emotion and by whom: classes, and fours that differ.

Fours tell content, emotion and style of speech apart (Chhatre et al. 2024, appendix B.4): two
texts, each spoken by two speakers, all in one emotion.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from motion.errors import InputError
from training.corpus.request import DESCRIPTION, read_request
from training.data.beat import BeatName
from training.data.take import TakeFolder
from training.data.windows import Windows


@dataclass(frozen=True)
class Classes:
    """Which values of a take's fields, as emotion and speaker, a network tells apart.

    Attributes
    ----------
    names : mapping of str to tuple of str
        By field the values, in the order of their numbers.
    """

    names: Mapping[str, tuple[str, ...]]

    @classmethod
    def of(cls, windows: Windows, fields: Iterable[str]) -> Self:
        """Return the classes of windows, in alphabetical order; what nobody told is none."""
        takes = windows.takes(np.arange(len(windows)))
        found = {field: {getattr(take, field) for take in takes} - {""} for field in fields}
        return cls({field: tuple(sorted(names)) for field, names in found.items()})

    def known(self, windows: Windows) -> NDArray[np.int64]:
        """Return the rows of windows whose fields are all among the classes."""
        takes = windows.takes(np.arange(len(windows)))
        return np.flatnonzero(
            [all(getattr(take, field) in of for field, of in self.names.items()) for take in takes]
        )

    def numbers(self, windows: Windows, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the numbers of the classes of windows, (fields, rows)."""
        takes = windows.takes(rows)
        return np.array(
            [[of.index(getattr(take, field)) for take in takes] for field, of in self.names.items()]
        )

    def means(self, field: str, values: Tensor, numbers: Tensor) -> dict[str, Tensor]:
        """Return the mean of `values` (rows, …) of each class that `numbers` (rows,) tell."""
        return {
            name: values[numbers == number].mean(dim=0)
            for number, name in enumerate(self.names[field])
            if bool((numbers == number).any())
        }


def macro_f1(told: NDArray[np.int64], true: NDArray[np.int64]) -> float:
    """Return the mean over classes of the harmonic mean of precision and recall."""
    scores = [
        2 * np.sum((told == one) & (true == one)) / (np.sum(told == one) + np.sum(true == one))
        for one in np.unique(true)
    ]
    return float(np.mean(scores))


def quadruples(
    windows: Windows, *, most: int, seed: int, needed: bool = False
) -> NDArray[np.int64]:
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
    needed : bool
        Whether nothing can be done without any.

    Returns
    -------
    ndarray, shape (quadruples, 4)
        None where no two speakers speak two texts in one emotion.

    Raises
    ------
    InputError
        If there are none, and some are needed.
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
    if needed and not len(rows):
        raise InputError(
            "no two speakers speak the same two texts in one emotion",
            remedy="Give recordings named as BEAT's are, or make a corpus with --shared-passages",
        )
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


def check_texts(takes: TakeFolder) -> None:
    """Check that names of recordings tell texts, as where speakers of a corpus share them.

    Raises
    ------
    InputError
        If they are those of a corpus whose speakers have texts of their own.
    """
    for folder in takes.takes[0].speech.resolve().parents:
        if (folder / DESCRIPTION).exists() and not read_request(folder).shared_passages:
            raise InputError(
                "each speaker of this corpus speaks texts of their own, and a speech model learns "
                "from texts that several speak",
                where=folder,
                remedy="Make a corpus with 'motionjury corpus --shared-passages'",
            )
