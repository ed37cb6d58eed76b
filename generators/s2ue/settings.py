"""What a condition tells Speech2UnifiedExpressions. Loads no torch."""

from __future__ import annotations

from pydantic import Field, field_validator

from generators.settings import File, Folder, ModelSettings, names_somebody

ANYBODY = "anybody"
"""In place of a speaker: somebody between those it learned from, whom the seed draws."""


class S2ueSettings(ModelSettings):
    """Which network moves, as whom, and what is said.

    Attributes
    ----------
    transcripts : Path or None
        Folder of transcripts, named as the segments; see `motion.formats.transcript`. None for the
        segments' own, spread over the speech.
    vectors : Path or None
        FastText's vectors of words, the same that the network learned from; None for a stand-in.
    speaker : int, str or None
        Number or name of one it learned from, or ``anybody``; None for who speaks in the segment.
    variation : float
        How far the speaker's latent is drawn from its mean: 0 not at all, 1 as in training.
    """

    transcripts: Folder | None = Field(
        None, description="Transcripts, named as the speech: .TextGrid, .csv, .lab or .txt."
    )
    vectors: File | None = Field(None, description="FastText's vectors; else a stand-in.")
    speaker: int | str | None = Field(
        None, description=f"As which of its speakers it moves: number, name or {ANYBODY}."
    )
    variation: float = Field(
        1.0, ge=0, le=3, description="How far from the speaker's mean it moves: 1."
    )

    _names_somebody = field_validator("speaker")(names_somebody)
