"""What a condition tells AMUSE. Loads no torch."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from generators.settings import File, ModelSettings, NameOrFile, content


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
    from_emotion, from_style : str, Path or None
        Told in the same way: what stands in for the speech's own where `strength` is 0.
    strength : float
        Where between the speech's own emotion and style, 0, and those that are named, 1, it moves.
    """

    speech_model: File = Field(description="Weights of the speech model.")
    content: File | None = Field(None, description="Recording whose words it moves to.")
    emotion: NameOrFile | None = Field(
        None, description="Emotion that it moves in: one it learned, or a recording."
    )
    style: NameOrFile | None = Field(
        None, description="As whom it moves: a speaker it learned from, or a recording."
    )
    from_emotion: NameOrFile | None = Field(
        None, description="Emotion that strength goes from, in place of the speech's own."
    )
    from_style: NameOrFile | None = Field(
        None, description="Style that strength goes from, in place of the speech's own."
    )
    strength: float = Field(
        1.0, ge=0, le=1, description="How far emotion and style go from the speech's own: 1."
    )

    @model_validator(mode="after")
    def _goes_somewhere(self) -> Self:
        """Refuse a beginning without an end."""
        for part in ("emotion", "style"):
            if getattr(self, f"from_{part}") is not None and getattr(self, part) is None:
                raise ValueError(f"from_{part} needs the {part} that it goes to")
        return self

    def fingerprint(self) -> tuple[object, ...]:
        """Return what changes with any value and the content of any file, not with its place."""
        return tuple(content(getattr(self, name)) for name in type(self).model_fields)
