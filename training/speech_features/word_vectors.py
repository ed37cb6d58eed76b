"""Word vectors: FastText's if a researcher names them, or a stand-in without meaning."""

import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from motion.arrays import Floats, Floats32
from motion.errors import InputError
from motion.files import sha256_of
from motion.formats.transcript import Word

WIDTH: Final = 300
"""Width of FastText's published vectors."""

_GRAMS: Final = (3, 4, 5, 6)
"""Lengths of the n-grams of a word, as in FastText."""


@dataclass(frozen=True)
class StandIn:
    """Seeded vectors, averaged over a word's n-grams, so that similar words are close."""

    width: int = WIDTH
    description: str = field(
        default="stand-in for FastText, which knows spelling but no meaning", init=False
    )

    def lookup(self, words: Iterable[str]) -> Mapping[str, Floats32]:
        """Return a vector for every word."""
        return {word: self._vector(word) for word in set(words)}

    def _vector(self, word: str) -> Floats32:
        marked = f"<{word}>"
        ngrams = {marked} | {
            marked[start : start + length]
            for length in _GRAMS
            for start in range(len(marked) - length + 1)
        }
        vectors = [_ngram_vector(zlib.crc32(part.encode()), self.width) for part in sorted(ngrams)]
        total = np.sum(vectors, axis=0)
        return np.asarray(total / np.sqrt(len(vectors)), np.float32)


@lru_cache(maxsize=20_000)
def _ngram_vector(seed: int, width: int) -> Floats:
    return np.random.default_rng(seed).standard_normal(width)


@dataclass(frozen=True)
class TextVectors:
    """FastText's ``.vec``: a header, then one line per word. Words not requested are skipped."""

    path: Path
    width: int
    description: str

    def lookup(self, words: Iterable[str]) -> Mapping[str, Floats32]:
        """Return the vectors of the words that are in the file."""
        requested = set(words)
        vectors: dict[str, Floats32] = {}
        with self.path.open(encoding="utf-8", errors="replace") as file:
            next(file)
            for number, line in enumerate(file, start=2):
                word, _, numbers = line.partition(" ")
                if word in requested:
                    vectors[word] = self._vector(numbers, number)
                    if len(vectors) == len(requested):
                        break
        return vectors

    def _vector(self, numbers: str, line: int) -> Floats32:
        try:
            vector = np.array(numbers.split(), np.float32)
        except ValueError:
            vector = np.zeros(0, np.float32)
        if vector.shape != (self.width,) or not np.isfinite(vector).all():
            raise InputError(
                f"the line holds no vector of {self.width} numbers",
                where=f"{self.path}, line {line}",
                remedy="Download the file again",
            )
        return vector


WordVectors = StandIn | TextVectors


def load_word_vectors(file: Path | str | None) -> WordVectors:
    """Return the vectors of a FastText text file, or the stand-in for None.

    Raises
    ------
    InputError
        If the file is not a FastText file.
    """
    if file is None:
        return StandIn()
    path = Path(file)
    try:
        with path.open(encoding="utf-8", errors="replace") as lines:
            count, width = (int(number) for number in next(lines).split())
        if count < 1 or width < 1:
            raise ValueError("no words")
    except (OSError, ValueError, StopIteration) as error:
        raise InputError(
            "the file holds no word vectors",
            where=path,
            remedy="Give FastText's .vec, whose first line has the numbers of words and values",
        ) from error
    return TextVectors(path, width, f"{path.name} (sha256 {sha256_of(path)[:16]})")


def word_rows(
    words: Sequence[Word], vectors: WordVectors, frames: int, frame_rate: float
) -> Floats32:
    """Return the vector of the word in each frame; zeros without a known word.

    Returns
    -------
    ndarray, shape (frames, width)
        Frame k is at ``k / frame_rate`` seconds; a word lasts at least one frame.
    """
    rows = np.zeros((frames, vectors.width), np.float32)
    known_vectors = vectors.lookup(word.text for word in words)
    for word in words:
        first = round(word.start * frame_rate)
        if word.text in known_vectors:
            rows[first : max(first + 1, round(word.end * frame_rate))] = known_vectors[word.text]
    return rows


def slice_rows(rows: Floats32 | None, first: int, frames: int, width: int) -> Floats32:
    """Return `frames` of `word_rows` from `first` on, (frames, width), padded with zeros."""
    excerpt = np.zeros((frames, width), np.float32)
    if rows is not None:
        inside = rows[first : first + frames]
        excerpt[: len(inside)] = inside
    return excerpt


def matching_vectors(path: Path | None, description: str, width: int, network: Path) -> WordVectors:
    """Return the word vectors of a file, if the network was trained with them.

    Parameters
    ----------
    path : Path or None
        The file; None for the stand-in.
    description : str
        The description of the vectors in training.
    width : int
        The width of the vectors in training.
    network : Path
        The network's file.

    Raises
    ------
    InputError
        If the vectors are not those of the training, or the file cannot be read.
    """
    vectors = load_word_vectors(path)
    if (vectors.description, vectors.width) != (description, width):
        raise InputError(
            f"the network was trained with {description} of width {width}, but these vectors are "
            f"{vectors.description} of width {vectors.width}",
            where=path or network,
            remedy="Name the same vectors, or none if it was trained with the stand-in",
        )
    return vectors
