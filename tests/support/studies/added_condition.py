"""The tiny study with a condition more, so that it has two comparisons, or with other videos."""

from __future__ import annotations

from pathlib import Path

from studyapp.study.media import read_stimuli, write_stimuli


def add_condition(folder: Path) -> None:
    """Add the condition ``static``, with copies of the videos of ``mismatched``."""
    definition = folder / "study.toml"
    text = definition.read_text("utf-8")
    before = "[conditions.mismatched]"
    assert before in text
    definition.write_text(text.replace(before, f"{before}\n[conditions.static]"), "utf-8")
    stimuli = read_stimuli(folder / "stimuli.json")
    names = {"mismatched": "static"}
    more = [
        pair.model_copy(
            update={
                "left": names.get(pair.left, pair.left),
                "right": names.get(pair.right, pair.right),
            }
        )
        for pair in stimuli.pairs
        if "mismatched" in (pair.left, pair.right)
    ]
    pairs = (*stimuli.pairs, *more)
    write_stimuli(folder / "stimuli.json", stimuli.model_copy(update={"pairs": pairs}))


def make_videos_anew(folder: Path) -> None:
    """Change the recorded sources of every pair."""
    stimuli = read_stimuli(folder / "stimuli.json")
    pairs = tuple(pair.model_copy(update={"key": f"{pair.key} anew"}) for pair in stimuli.pairs)
    write_stimuli(folder / "stimuli.json", stimuli.model_copy(update={"pairs": pairs}))
