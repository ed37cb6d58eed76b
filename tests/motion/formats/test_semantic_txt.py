from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from motion.formats.semantic_txt import SemanticSpan, read_semantic_scores, semantic_weights


def test_annotations_are_read_as_beat_writes_them(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text(
        '01_beat_align\t0.0\t1.5\t1.5\t0.1\t\n\n05_iconic_h\t1.5\t2.0\t0.5\t0.9\tsay "big\n',
        encoding="utf-8",
    )
    assert read_semantic_scores(path) == (
        SemanticSpan(start=0.0, end=1.5, score=0.1),
        SemanticSpan(start=1.5, end=2.0, score=0.9),
    )


@pytest.mark.parametrize(
    "row", ["name\t0\t1", "name\tx\t1\t1\t0.5", "name\t2\t1\t1\t0.5", "name\t0\t1\t1\tnan"]
)
def test_a_row_that_is_no_annotation_is_named(tmp_path: Path, row: str) -> None:
    path = tmp_path / "a.txt"
    path.write_text(f"ok\t0\t1\t1\t0.5\n{row}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"a\.txt, line 2: the row is not an annotation"):
        read_semantic_scores(path)


def test_a_file_that_is_missing_or_no_text_is_named(tmp_path: Path) -> None:
    (tmp_path / "b.txt").write_bytes(b"\xff\xfe\x00")
    for name in ("a.txt", "b.txt"):
        with pytest.raises(InputError, match=name):
            read_semantic_scores(tmp_path / name)


def test_frames_get_the_greater_score_of_what_they_lie_in() -> None:
    spans = (
        SemanticSpan(start=0.5, end=1.5, score=0.2),
        SemanticSpan(start=1.0, end=2.0, score=0.7),
    )
    assert semantic_weights(spans, 6, 2.0).tolist() == [0, 0.2, 0.7, 0.7, 0, 0]
