"""What a condition tells AMUSE. Loads no torch."""

from __future__ import annotations

from pathlib import Path
from typing import Self

from pydantic import Field

from generators.settings import File, ModelSettings, content
from motion.errors import InputError


class AmuseSettings(ModelSettings):
    """Which networks move, and what stands in for parts of the speech.

    A part that is not named is the speech's own. Naming one edits the motion: with `emotion`, the
    same words by the same person in another emotion.

    Attributes
    ----------
    checkpoint : Path
        The motion prior and the denoiser.
    speech_model : Path
        The speech disentanglement model.
    content : Path or None
        Recording whose words are moved to.
    emotion, style : str, Path or None
        An emotion or a speaker that the speech model learned, or a recording to hear it from;
        `within` tells the two apart.
    strength : float
        Where between the speech's own emotion and style, 0, and those that are named, 1, it moves.
    """

    speech_model: File = Field(description="Weights of the speech model.")
    content: File | None = Field(None, description="Recording whose words it moves to.")
    emotion: str | Path | None = Field(
        None, description="Emotion that it moves in: one it learned, or a recording."
    )
    style: str | Path | None = Field(
        None, description="As whom it moves: a speaker it learned from, or a recording."
    )
    strength: float = Field(
        1.0, ge=0, le=1, description="How far emotion and style go from the speech's own: 1."
    )

    def within(self, folder: Path) -> Self:
        """Return the settings with paths from `folder`; see `Settings.within`."""
        found = {part: _recording(part, getattr(self, part), folder) for part in _VOICES}
        return super().within(folder).model_copy(update=found)

    def fingerprint(self) -> tuple[object, ...]:
        """Return what changes with any value and the content of any file, not with its place."""
        files = (self.checkpoint, self.speech_model, self.content, self.emotion, self.style)
        return (*(content(file) for file in files), self.strength)


_VOICES = ("emotion", "style")


def _recording(part: str, named: str | Path | None, folder: Path) -> str | Path | None:
    """Return the path of a recording from `folder`, or what else is named as it is."""
    if named is None or not Path(named).suffix:
        return named
    path = folder / named
    if not path.is_file():
        raise InputError(
            f"there is no such recording of {part}", where=path, remedy="Check the path"
        )
    return path
