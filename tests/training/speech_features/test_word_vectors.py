"""Words become vectors: FastText's, or a stand-in's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats.transcript import Word
from training.speech_features.word_vectors import StandIn, read_word_vectors, word_rows

WORDS = (Word("hello", 0.0, 0.2), Word("nobody", 0.2, 0.3), Word("hi", 0.35, 0.36))


def test_the_stand_in_is_the_same_each_time_and_knows_spelling() -> None:
    result = StandIn().lookup(["walking", "walked", "sea"])
    again = StandIn().lookup(["walking"])
    assert result["walking"].shape == (300,)
    np.testing.assert_array_equal(result["walking"], again["walking"])
    near, far = (np.corrcoef(result["walking"], result[word])[0, 1] for word in ("walked", "sea"))
    assert near > 0.2 > far


def test_fasttexts_text_is_read_for_the_words_that_are_asked(tmp_path: Path) -> None:
    path = tmp_path / "wiki.vec"
    path.write_text("3 2\nhello 1 2\nbroken 1\nhi 3 4\n")
    vectors = read_word_vectors(path)
    assert (vectors.width, vectors.description) == (2, "wiki.vec")
    rows = word_rows(WORDS, vectors, 6, 15.0)
    np.testing.assert_array_equal(rows, [[1, 2], [1, 2], [1, 2], [0, 0], [0, 0], [3, 4]])
    with pytest.raises(InputError, match="line 3: the line holds no vector of 2 numbers"):
        vectors.lookup(["broken"])


@pytest.mark.parametrize("content", ["", "hello 1 2\n", "0 0\n"])
def test_a_file_without_vectors_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "a.vec").write_text(content)
    with pytest.raises(InputError, match="holds no vectors of words"):
        read_word_vectors(tmp_path / "a.vec")
