"""`[video]` and `[watching]` of `study.toml`: how stimuli look, and what counts as watched."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from studyapp.study.settings.section import Section


class Video(Section):
    """How all stimuli of the study look.

    Attributes
    ----------
    size : int
        Pixels along each side of one clip; a pair is twice as wide.
    avatar : str
        Who is shown, the same for all conditions: a name in `renderer.avatars.AVATARS`.
    body : str or None
        A licensed SMPL-X model file (``.npz``) to show instead of an avatar.
    expression_matrix : str or None
        A file (``.npz``, ``.npy`` or ``.csv``) of 100 SMPL-X expression coefficients by 52 ARKit
        actions, which turns the one into the other where the body shows only that.
    """

    framing: Literal["upper_body", "full_body"] = "upper_body"
    size: int = Field(720, ge=64, le=1440, multiple_of=2)
    frame_rate: int = Field(30, ge=10, le=60)
    avatar: Literal["alex", "maya", "jonas", "amara", "henry", "mannequin"] = "alex"
    body: str | None = None
    expression_matrix: str | None = None


class Watching(Section):
    """What counts as having watched, and how much there may be to load for it.

    Attributes
    ----------
    coverage : float
        The share of each video that must really have played.
    megabytes_per_page : float
        What one page may load at most: its own videos, and those fetched ahead for the next one.
    """

    coverage: float = Field(0.95, ge=0, le=1, strict=False)
    megabytes_per_page: float = Field(60, gt=0, le=10_000, strict=False)
