"""Windows labelled by content, emotion and speaker, and the quadruples that disentangle them.

A quadruple separates the content of speech from its style (Chhatre et al. 2024, appendix B.4): two
texts, each spoken by two speakers, all in one emotion.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np
from torch import Tensor

from motion.arrays import Ints
from motion.errors import InputError
from training.corpus.plan import DESCRIPTION
from training.data.beat import BeatName
from training.data.take import TakeFolder
from training.data.windows import Windows


@dataclass(frozen=True)
class Classes:
    """The labels that a network distinguishes, for fields of a take such as emotion and speaker.

    Attributes
    ----------
    names : mapping of str to tuple of str
        The labels of each field, in the order of their class numbers.
    """

    names: Mapping[str, tuple[str, ...]]

    @classmethod
    def from_windows(cls, windows: Windows, fields: Iterable[str]) -> Self:
        """Return the classes of windows in alphabetical order; an empty label is not a class."""
        takes = windows.takes(np.arange(len(windows)))
        labels = {field: {getattr(take, field) for take in takes} - {""} for field in fields}
        return cls({field: tuple(sorted(values)) for field, values in labels.items()})

    def labelled_rows(self, windows: Windows) -> Ints:
        """Return the rows of windows whose labels are all among the classes."""
        takes = windows.takes(np.arange(len(windows)))
        return np.flatnonzero(
            [
                all(getattr(take, field) in labels for field, labels in self.names.items())
                for take in takes
            ]
        )

    def numbers(self, windows: Windows, rows: Ints) -> Ints:
        """Return the class numbers of windows, (fields, rows)."""
        takes = windows.takes(rows)
        return np.array(
            [
                [labels.index(getattr(take, field)) for take in takes]
                for field, labels in self.names.items()
            ]
        )

    def means(self, field: str, values: Tensor, numbers: Tensor) -> dict[str, Tensor]:
        """Return the mean of `values` (rows, …) over each class; `numbers` is (rows,)."""
        return {
            name: values[numbers == number].mean(dim=0)
            for number, name in enumerate(self.names[field])
            if bool((numbers == number).any())
        }


def macro_f1(predicted: Ints, actual: Ints) -> float:
    """Return the mean over classes of the harmonic mean of precision and recall."""
    scores = [
        2
        * np.sum((predicted == label) & (actual == label))
        / (np.sum(predicted == label) + np.sum(actual == label))
        for label in np.unique(actual)
    ]
    return float(np.mean(scores))


def quadruples(windows: Windows, *, limit: int, seed: int, required: bool = False) -> Ints:
    """Return quadruples of windows: contents c1 and c2, each spoken by speakers s1 and s2.

    The columns are (c1, s1), (c2, s1), (c1, s2), (c2, s2). The four windows of a quadruple start
    at the same time in their recordings.

    Parameters
    ----------
    windows : Windows
        Windows of takes with BEAT's names, which tell the text.
    limit : int
        Largest number of quadruples; if there are more, a random sample is returned.
    seed : int
        Seed of the sample.
    required : bool
        Whether to raise if there are no quadruples.

    Returns
    -------
    ndarray, shape (quadruples, 4)
        Rows of the windows; empty if no two speakers speak two texts in one emotion.

    Raises
    ------
    InputError
        If quadruples are required and there are none.
    """
    groups = [
        group
        for emotion, texts in _by_emotion(windows).items()
        for c1, c2 in combinations(sorted(texts), 2)
        for s1, s2 in combinations(sorted(set(texts[c1]) & set(texts[c2])), 2)
        for group in zip(
            texts[c1][s1], texts[c2][s1], texts[c1][s2], texts[c2][s2], strict=False
        )
        if emotion
    ]  # fmt: skip
    rows = np.array(groups, dtype=np.int64).reshape(-1, 4)
    if required and not len(rows):
        raise InputError(
            "no two speakers speak the same two texts in one emotion",
            remedy="Give recordings with BEAT's names, or make a corpus with --shared-passages",
        )
    if len(rows) <= limit:
        return rows
    return rows[np.sort(np.random.default_rng(seed).choice(len(rows), limit, replace=False))]


def _by_emotion(windows: Windows) -> dict[str, dict[str, dict[str, list[int]]]]:
    """Return the rows of windows by emotion, text and speaker."""
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
    """Raise `InputError` for a synthetic corpus whose speakers do not share their texts."""
    for folder in takes.takes[0].speech.resolve().parents:
        corpus = folder / DESCRIPTION
        if corpus.exists() and not json.loads(corpus.read_text("utf-8"))["shared_passages"]:
            raise InputError(
                "each speaker of this corpus has their own texts, but a speech model learns from "
                "texts that several speakers share",
                where=folder,
                remedy="Make a corpus with 'motionjury corpus --shared-passages'",
            )
