"""The tiny study with a condition more, so that it has two comparisons, or with other videos."""

from pathlib import Path

from studyapp.study.media import read_stimuli, write_stimuli
from tests.support.studies.redefining import redefine


def add_condition(folder: Path) -> None:
    """Add the condition ``static``, with copies of the videos of ``mismatched``."""
    before = "[conditions.mismatched]"
    redefine(folder, (before, f"{before}\n[conditions.static]"))
    stimuli = read_stimuli(folder / "stimuli.json")
    more = [
        pair.model_copy(update={side: "static"})
        for pair in stimuli.pairs
        for side in ("left", "right")
        if getattr(pair, side) == "mismatched"
    ]
    pairs = (*stimuli.pairs, *more)
    write_stimuli(folder / "stimuli.json", stimuli.model_copy(update={"pairs": pairs}))


def make_videos_anew(folder: Path) -> None:
    """Change the recorded sources of every pair."""
    stimuli = read_stimuli(folder / "stimuli.json")
    pairs = tuple(pair.model_copy(update={"key": f"{pair.key} anew"}) for pair in stimuli.pairs)
    write_stimuli(folder / "stimuli.json", stimuli.model_copy(update={"pairs": pairs}))
