"""What a condition tells DiffSHEG, and which steps FOPPAS then takes through the noise.

Fast outpainting-based partial autoregressive sampling (section 3.5): DDIM in place of DDPM, and
RePaint's resampling for the windows that continue another one. Loads no torch.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType
from typing import Any, Final, Literal

from pydantic import Field, field_validator, model_validator

from generators.settings import Folder, ModelSettings, Settings, content, names_somebody
from motion.errors import InputError
from training.noise_schedule import LINEAR_NOISE

CLEAN: Final = -1
"""The place where no noise is left."""


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """How windows are sampled.

    Attributes
    ----------
    steps : int
        Steps of DDIM from pure noise to a clean window.
    overlap : int
        Frames that a window shares with the one before.
    entry : int
        Steps of a window that continues another one.
    jump_length : int
        Steps that resampling goes back into the noise at once.
    jump_count : int
        How often each such stretch is walked: 1 for no resampling, 2 as the release's fast
        setting, 5 as its careful one.
    blend_below : float
        Shared frames blend linearly into the new window while less noise than this is left, as a
        standard deviation; before, they are what the window before says.
    keeps_pose : bool
        Whether a window that continues another one sets out from noise around the last pose it
        knows. The release sets out from pure noise, although a twenty-fifth of the motion's
        variance should be left by then: slow parts of the motion fade from window to window.
    own_noise : bool
        Whether shared frames get the noise that the network has just found in them; RePaint and
        the release give them fresh noise at each step, with which the new frames do not agree.
    """

    steps: int = 25
    overlap: int = 4
    entry: int = 15
    jump_length: int = 3
    jump_count: int = 2
    blend_below: float = 0.2
    keeps_pose: bool = False
    own_noise: bool = False

    def __post_init__(self) -> None:
        least = {"steps": 1, "entry": 1, "jump_length": 1, "jump_count": 1, "overlap": 0}
        for name, minimum in least.items():
            if getattr(self, name) < minimum:
                raise InputError(
                    f"sampling with {name} {getattr(self, name)} is not possible",
                    remedy=f"Give at least {minimum}",
                )
        if LINEAR_NOISE.steps % self.steps:
            raise InputError(
                f"{self.steps} steps do not divide the {LINEAR_NOISE.steps} of the training",
                remedy="Give 10, 20, 25, 40, 50 or 100 steps",
            )
        if self.entry > self.steps:
            raise InputError(
                f"a window cannot be entered {self.entry} steps before the end of {self.steps}",
                remedy="Give an entry of at most the number of steps",
            )

    @cached_property
    def timesteps(self) -> tuple[int, ...]:
        """The diffusion step at each place, from the least noise to the most."""
        return tuple(range(0, LINEAR_NOISE.steps, LINEAR_NOISE.steps // self.steps))

    @cached_property
    def first_walk(self) -> tuple[int, ...]:
        """Places of a window that continues none, down to `CLEAN`."""
        return (*range(self.steps - 1, -1, -1), CLEAN)

    @cached_property
    def later_walk(self) -> tuple[int, ...]:
        """Places of a window that continues another one, down to `CLEAN`.

        Lugmayr et al. 2022 (RePaint), Figure 9: each stretch of `jump_length` steps is walked
        `jump_count` times, noise being added in between.
        """
        left = dict.fromkeys(
            range(0, self.entry - self.jump_length, self.jump_length), self.jump_count - 1
        )
        place, places = self.entry - 1, [self.entry - 1]
        while place >= 0:
            if left.get(place, 0):
                left[place] -= 1
                places += range(place + 1, place + self.jump_length + 1)
                place += self.jump_length
            place -= 1
            places.append(place)
        return tuple(places)


def evaluations(walk: tuple[int, ...]) -> int:
    """Return how often the network is asked on a walk: once for every step down."""
    return sum(there < here for here, there in pairwise(walk))


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
        See `Sampling`; None for what the setting has. `overlap` is the
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
