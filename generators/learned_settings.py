"""Settings of learned generators; does not load torch."""

from functools import cached_property
from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from generators.settings import File, Folder, NameOrFile, Settings, content


def _check_speaker(speaker: int | str | None) -> int | str | None:
    if speaker in (0, "") or (isinstance(speaker, int) and speaker < 0):
        raise ValueError("give the speaker's number, from 1, or name")
    return speaker


class ModelSettings(Settings):
    """Settings of a learned generator.

    Attributes
    ----------
    checkpoint : Path
        The network's weights.
    """

    checkpoint: File = Field(description="Weights of a learned generator.")

    @cached_property
    def checkpoint_sha256(self) -> str:
        """Hash of the checkpoint's file."""
        return str(content(self.checkpoint))


class DiffShegSettings(ModelSettings):
    """The network, and the speaker to move as.

    Attributes
    ----------
    dataset : {'beat', 'show'}
        The data set of a released checkpoint; files trained here record it.
    stats : Path or None
        Folder of means and standard deviations, which a released checkpoint needs.
    hubert : Path or None
        Folder of HuBERT's weights; None for a stand-in that does not recognise words.
    speaker : int, str or None
        Number of the speaker in the data set, from 1, or the name if the checkpoint has names. None
        for the segment's speaker if the checkpoint has names, or else the first one.
    sampling : {'smooth', 'fast', 'careful', 'plain'}
        How windows are sampled, one of `generators.diffsheg.config.SAMPLINGS`.
    steps : int
        Number of steps from noise to motion; it must divide 1000.
    overlap : int or None
        Frames that windows share; None for the release's number, or 1.5 times that in ``smooth``.
    """

    dataset: Literal["beat", "show"] = Field(
        "beat", description="Data set of released weights; default beat."
    )
    stats: Folder | None = Field(None, description="Means and deviations of released weights.")
    hubert: Folder | None = Field(None, description="HuBERT's weights; without them, a stand-in.")
    speaker: int | str | None = Field(None, description="Speaker to move as: number or name.")
    sampling: Literal["smooth", "fast", "careful", "plain"] = Field(
        "smooth",
        description="How windows are sampled; fast and careful as released; default smooth.",
    )
    steps: int = Field(25, ge=1, description="Steps from noise to motion; default 25.")
    overlap: int | None = Field(
        None,
        ge=0,
        description="Frames that windows share; default 6 for BEAT and 15 for SHOW, and 4 and 10 "
        "if sampling is not smooth.",
    )

    _speaker = field_validator("speaker")(_check_speaker)

    @model_validator(mode="after")
    def _divides_the_training(self) -> Self:
        if 1000 % self.steps:
            raise ValueError(
                f"{self.steps} steps do not divide the 1000 of the training. Give 10, 20, 25, 40, "
                "50 or 100 steps"
            )
        return self


class AmuseSettings(ModelSettings):
    """The networks, and replacements of parts of the speech.

    A part that is not named is the speech's own. Naming a part edits the motion: `emotion` gives
    the same words by the same person in another emotion.

    Attributes
    ----------
    checkpoint : Path
        The motion prior and the denoiser.
    speech_model : Path
        The speech disentanglement model.
    content : Path or None
        Recording that provides the content.
    emotion, style : str, Path or None
        An emotion or a speaker that the speech model learned, or a recording that provides it; a
        recording's name has a suffix.
    from_emotion, from_style : str, Path or None
        The same, in place of the speech's own at `strength` 0.
    strength : float
        Interpolates from the speech's own emotion and style, 0, to the chosen ones, 1.
    """

    speech_model: File = Field(description="Weights of the speech model.")
    content: File | None = Field(None, description="Recording whose words it moves to.")
    emotion: NameOrFile | None = Field(
        None, description="Emotion that it moves in: one it learned, or a recording."
    )
    style: NameOrFile | None = Field(
        None, description="Style to move in: a speaker it learned from, or a recording."
    )
    from_emotion: NameOrFile | None = Field(
        None, description="Emotion at --strength 0, instead of the speech's own."
    )
    from_style: NameOrFile | None = Field(
        None, description="Style at --strength 0, instead of the speech's own."
    )
    strength: float = Field(
        1.0,
        ge=0,
        le=1,
        description="How far to go from the speech's own emotion and style; default 1.",
    )


class S2ueSettings(ModelSettings):
    """The network, the speaker to move as, and the text.

    Attributes
    ----------
    transcripts : Path or None
        Folder of transcripts, named after the segments; see `motion.formats.transcript`. None for
        the segments' own text, spread over the speech.
    vectors : Path or None
        FastText's word vectors, the same as in training; None for the stand-in.
    speaker : int, str or None
        Number or name of a training speaker; None for the segment's speaker.
    variation : float
        Scale of the random variation of the speaker's latent: 0 for its mean, 1 as in training.
    """

    transcripts: Folder | None = Field(
        None, description="Transcripts, named as the speech: .TextGrid, .csv, .lab or .txt."
    )
    vectors: File | None = Field(None, description="FastText's vectors; without them, a stand-in.")
    speaker: int | str | None = Field(None, description="Speaker to move as: number or name.")
    variation: float = Field(
        1.0, ge=0, le=3, description="How far from the speaker's mean it moves; default 1."
    )

    _speaker = field_validator("speaker")(_check_speaker)
