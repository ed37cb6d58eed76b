"""A take checks itself."""

from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from training.data.take import Take


def take(**changes: object) -> Take:
    facts: dict[str, object] = {
        "name": "2_scott_0_9_9",
        "speaker": "scott",
        "emotion": "",
        "split": "train",
        "speech": Path("a.wav"),
        "motion": Path("a.bvh"),
    }
    return Take(**{**facts, **changes})  # type: ignore[arg-type]


def test_its_files_are_those_it_has() -> None:
    assert take().files == (Path("a.wav"), Path("a.bvh"))
    face = take(face=Path("a.json"), semantic=Path("a.txt"))
    assert face.files[2:] == (Path("a.json"), Path("a.txt"))


@pytest.mark.parametrize("changes", [{"name": "a/b"}, {"name": ""}, {"emotion": "boredom"}])
def test_unusable_names_and_emotions_are_refused(changes: dict[str, str]) -> None:
    with pytest.raises(InputError, match=r"no usable take name|unknown emotion 'boredom'"):
        take(**changes)
