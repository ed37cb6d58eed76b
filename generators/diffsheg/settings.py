"""What a condition tells DiffSHEG. Loads no torch."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final, Literal

from pydantic import Field, field_validator, model_validator

from generators.diffsheg.walk import Sampling
from generators.settings import Folder, ModelSettings, Settings, content, names_somebody
from motion.errors import InputError

PRESETS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "smooth": {"jump_count": 2, "keeps_pose": True, "own_noise": True},
        "fast": {"jump_count": 2},
        "careful": {"jump_count": 5},
        "plain": {"jump_count": 1},
    }
)
"""Settings by name: as fast as the release's fast one, but smoother where windows meet and with
poses as varied as the network's; the release's fast one; its careful one; no resampling."""

_SHARED_MORE: Final[Mapping[str, float]] = MappingProxyType({"smooth": 1.5})
"""By how much more frames the windows of a setting share than the release's."""

_ENTRY_SHARE: Final = 0.6
"""Share of the steps that a continuing window walks where nothing is said: 15 of the paper's 25."""


class SamplingSettings(Settings):
    """A named setting, and what is to differ from it; ``sampling = "careful"`` is the name alone.

    Attributes
    ----------
    preset : {'smooth', 'fast', 'careful', 'plain'}
        One of `PRESETS`.
    steps, overlap, entry, jump_length, jump_count : int or None
        See `generators.diffsheg.walk.Sampling`; None for what the setting has. `overlap` is the
        release's for the data set, half as much again in ``smooth``; `entry` is three fifths of
        the steps.
    blend_below : float or None
        None for what the setting has.
    """

    preset: Literal["smooth", "fast", "careful", "plain"] = Field(
        "smooth", description="How windows are sampled; fast and careful as released: smooth."
    )
    steps: int | None = Field(None, description="Steps from noise to motion: 25.")
    overlap: int | None = Field(
        None, description="Frames that windows share: 4 of BEAT, 10 of SHOW."
    )
    entry: int | None = Field(
        None, description="Steps of a window that continues another: three fifths of all."
    )
    jump_length: int | None = Field(None, description="Steps that resampling goes back at once: 3.")
    jump_count: int | None = Field(
        None, description="How often each stretch is walked: 2 fast, 5 careful."
    )
    blend_below: float | None = Field(None, description="Noise below which windows blend: 0.2.")

    @model_validator(mode="before")
    @classmethod
    def _has_a_known_name(cls, given: Any) -> Any:
        name = given.get("preset", "smooth") if isinstance(given, Mapping) else given
        if isinstance(name, str) and name not in PRESETS:
            raise ValueError(
                f"there is no sampling called {name!r}. Use one of {', '.join(PRESETS)}"
            )
        return given

    @model_validator(mode="after")
    def _can_be_sampled(self) -> SamplingSettings:
        if self.blend_below is not None and not 0 <= self.blend_below <= 1:
            raise ValueError(
                f"motion cannot be blended below a noise of {self.blend_below:g}. Give a standard "
                "deviation from 0, for no blending, to 1"
            )
        try:
            self.sampling(overlap=0)
        except InputError as error:
            raise ValueError(f"{error.what}. {error.remedy}") from error
        return self

    def sampling(self, *, overlap: int) -> Sampling:
        """Return how windows are sampled, of which the release's share `overlap` frames."""
        chosen = self.model_dump(exclude={"preset"}, exclude_none=True)
        shared = round(overlap * _SHARED_MORE.get(self.preset, 1))
        settings = {"overlap": shared, **PRESETS[self.preset], **chosen}
        if self.entry is None and self.steps is not None:
            settings["entry"] = max(1, round(_ENTRY_SHARE * self.steps))
        return Sampling(**settings)

    def fingerprint(self) -> tuple[object, ...]:
        """Return how windows are sampled, whatever it is called."""
        return (self.overlap, self.sampling(overlap=0))


class DiffShegSettings(ModelSettings):
    """Which network moves, and as whom.

    Attributes
    ----------
    dataset : {'beat', 'show'}
        What a released checkpoint was trained on; files trained here know it themselves.
    stats : Path or None
        Folder of means and standard deviations, which a released checkpoint needs.
    hubert : Path or None
        Folder of HuBERT's weights; None for a stand-in that hears no words.
    speaker : int, str or None
        Number of the speaker in the data set, from 1, or the name where the checkpoint knows names.
        None for who speaks in the segment, as far as the checkpoint knows names; else the first.
    sampling : SamplingSettings
        How windows are sampled.
    """

    dataset: Literal["beat", "show"] = Field("beat", description="What a release learned: beat.")
    stats: Folder | None = Field(None, description="Means and deviations of a release.")
    hubert: Folder | None = Field(None, description="HuBERT's weights; else a stand-in hears.")
    speaker: int | str | None = Field(
        None, description="As which of its speakers it moves: number or name."
    )
    sampling: SamplingSettings = SamplingSettings()

    _names_somebody = field_validator("speaker")(names_somebody)

    def fingerprint(self) -> tuple[object, ...]:
        """Return what changes with the content of any file and with any value."""
        folders = [content(folder) for folder in (self.stats, self.hubert) if folder is not None]
        files = [file for folder in folders if isinstance(folder, tuple) for file in folder]
        return (
            self.checkpoint_sha256,
            self.dataset,
            self.speaker,
            content(self.sampling),
            *files,
        )
