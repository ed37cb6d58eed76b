"""How a learned generator of a condition samples its windows."""

from __future__ import annotations

from typing import Any

from pydantic import Field, model_validator

from generators.diffsheg.walk import DEFAULT, SamplingSettings
from motion.errors import InputError
from studyapp.definition.section import Section


class SamplingSection(Section):
    """A named setting, and what differs from it; ``sampling = "careful"`` is the name alone.

    Attributes
    ----------
    preset : str
        One of `generators.diffsheg.walk.PRESETS`.
    steps, overlap, entry, jump_length, jump_count, blend_below
        See `generators.diffsheg.walk.Sampling`; what the setting has where nothing is said.
    """

    preset: str = DEFAULT
    steps: int | None = None
    overlap: int | None = None
    entry: int | None = None
    jump_length: int | None = None
    jump_count: int | None = None
    blend_below: float | None = Field(None, strict=False)

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, value: Any) -> Any:
        return {"preset": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _can_be_sampled(self) -> SamplingSection:
        try:
            self.settings()
        except InputError as error:
            raise ValueError(f"{error.what}. {error.remedy}") from error
        return self

    def settings(self) -> SamplingSettings:
        """Return what a generator is given."""
        return SamplingSettings(**self.model_dump())
