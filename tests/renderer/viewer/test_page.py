from __future__ import annotations

import hashlib

import pytest

from motion.clip import MotionClip
from motion.errors import InputError
from renderer.look import Look
from renderer.viewer.page import FILES, MotionFigures, Scene


def test_the_bundled_library_matches_its_readme() -> None:
    library = (FILES / "three.min.js").read_bytes()

    assert hashlib.sha256(library).hexdigest() in (FILES / "README.md").read_text()
    assert b"three 0.187.0, MIT" in library[:80]


def test_shared_data_of_two_figures_is_embedded_once(clip: MotionClip) -> None:
    figures = MotionFigures(Look())
    for name in ("first", "second"):
        figures.figure(Scene(name=name, clips={name: clip}))

    assert figures.sources().count("<script") == 2


def test_names_are_escaped(clip: MotionClip) -> None:
    element = MotionFigures(Look()).figure(Scene(name="<b>", clips={"'><script>": clip}))

    assert "<b>" not in element
    assert "<script>" not in element


@pytest.mark.parametrize("count", [0, 7])
def test_too_few_or_too_many_clips_are_refused(count: int, clip: MotionClip) -> None:
    scene = Scene(name="many", clips={str(number): clip for number in range(count)})

    with pytest.raises(InputError, match="do not fit side by side"):
        MotionFigures(Look()).figure(scene)
