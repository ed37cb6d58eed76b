"""Sizes of DiffSHEG networks, and their default training."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal

from training.config import Preset, read_presets
from training.diffusion import LINEAR

Flow = Literal["expression_to_gesture", "gesture_to_expression", "none", "joint"]
"""Which branch conditions which: see `DenoiserConfig.flow`."""

Loudness = Literal["power", "logarithm"]
"""How mel bands are read: see `DenoiserConfig.loudness`."""

CLEAN: Final = -1
"""The place of a walk where no noise is left."""

JUMP_LENGTH: Final = 3
"""Steps that resampling goes back into the noise at once."""

BLEND_BELOW: Final = 0.2
"""Shared frames blend linearly into the new window while less noise than this is left, as a
standard deviation; before, they are what the window before says."""

JOINT_WIDENING: Final = 1.41
"""Ratio of widths by which the one branch of 'joint' costs as much as two (section 4.5)."""


@dataclass(frozen=True, kw_only=True)
class DenoiserConfig:
    """Sizes of a denoiser, and the ablations of the paper's Table 1 as switches.

    Attributes
    ----------
    gesture_width, expression_width : int
        Values of body and of face in a frame; a frame is the body's, then the face's.
    speakers : int
        Length of the speaker's one-hot vector.
    frames : int
        Frames of the windows it is trained on.
    frame_rate : float
        Frames per second.
    width, feed_forward, heads, layers : int
        Sizes of the transformer of each branch.
    audio_width, speech_width : int
        Mel bands, and width of what the shared encoder makes of them; channels that each branch
        makes of the speech features.
    speech_features : int
        Channels of the speech features (HuBERT).
    dropout : float
        While training, in [0, 1).
    longest : int
        Frames that have a position.
    flow : {'expression_to_gesture', 'gesture_to_expression', 'none', 'joint'}
        Which branch gets the other's estimate of the clean motion: as in the paper; the
        other way round ('Reverse Direction'); none ('w/o x̂0'); or a single, wider branch for body
        and face together ('Naive Concat').
    detached : bool
        Whether gradients stop at that estimate; False is 'w/o Detach'.
    guidance : float or None
        How far its estimate is driven away from that of a network which is told nothing, 1 for not
        at all (Ho & Salimans 2021); as the release has it for SHOW. None: it cannot be told
        nothing.
    loudness : {'power', 'logarithm'}
        How it reads mel bands: their power, as the release does, which spans nine decades and is
        next to nothing but in the loudest moments; or its logarithm, scaled to about -1 to 3.
    skip : bool
        Whether what of the noise follows from the covariance of the motion it learns from goes past
        the layers of each branch: see `generators.diffsheg.layers.LinearSkip`. Without, as the
        paper has it, all noise passes through them, and a branch narrower than its part of the
        motion loses some of it on the way.
    """

    gesture_width: int
    expression_width: int
    speakers: int
    frames: int
    frame_rate: float
    width: int = 512
    feed_forward: int = 1024
    heads: int = 8
    layers: int = 8
    audio_width: int = 128
    speech_width: int = 128
    speech_features: int = 1024
    dropout: float = 0.1
    longest: int = 1200
    flow: Flow = "expression_to_gesture"
    detached: bool = True
    guidance: float | None = None
    loudness: Loudness = "power"
    skip: bool = False

    @property
    def motion_width(self) -> int:
        """Values in a frame."""
        return self.gesture_width + self.expression_width

    @property
    def style_width(self) -> int:
        """Width of what diffusion step and speaker become."""
        return 4 * self.width

    @property
    def joint_width(self) -> int:
        """Width of the one branch of 'joint', a multiple of what its heads need."""
        step = 2 * self.heads
        return step * round(self.width * JOINT_WIDENING / step)


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """Sampling of windows: fast outpainting-based partial autoregressive sampling.

    FOPPAS (section 3.5) is DDIM in place of DDPM, and RePaint's resampling for the windows that
    continue another one.

    Attributes
    ----------
    steps : int
        Steps of DDIM from pure noise to a clean window.
    overlap : int
        Frames that a window shares with the one before.
    jump_count : int
        How often each stretch of `JUMP_LENGTH` steps is walked: 1 for no resampling, 2 as the
        release's fast setting, 5 as its careful one.
    smooth : bool
        Whether a window that continues another one sets out from noise around the last pose it
        knows, and its shared frames get the noise that the network has just found in them. The
        release sets out from pure noise, although a twenty-fifth of the motion's variance should be
        left by then: slow parts of the motion fade from window to window. It and RePaint give
        shared frames fresh noise at each step, with which the new frames do not agree.
    """

    steps: int = 25
    overlap: int = 4
    jump_count: int = 2
    smooth: bool = False

    @property
    def entry(self) -> int:
        """Steps of a window that continues another one: 15 of the paper's 25."""
        return max(1, round(0.6 * self.steps))

    @cached_property
    def timesteps(self) -> tuple[int, ...]:
        """The diffusion step at each place, from the least noise to the most."""
        return tuple(range(0, LINEAR.steps, LINEAR.steps // self.steps))

    @cached_property
    def first_walk(self) -> tuple[int, ...]:
        """Places of a window that continues none, down to `CLEAN`."""
        return (*range(self.steps - 1, -1, -1), CLEAN)

    @cached_property
    def later_walk(self) -> tuple[int, ...]:
        """Places of a window that continues another one, down to `CLEAN`.

        Lugmayr et al. 2022 (RePaint), Figure 9: each stretch of `JUMP_LENGTH` steps is walked
        `jump_count` times, noise being added in between.
        """
        left = dict.fromkeys(range(0, self.entry - JUMP_LENGTH, JUMP_LENGTH), self.jump_count - 1)
        place, places = self.entry - 1, [self.entry - 1]
        while place >= 0:
            if left.get(place, 0):
                left[place] -= 1
                places += range(place + 1, place + JUMP_LENGTH + 1)
                place += JUMP_LENGTH
            place -= 1
            places.append(place)
        return tuple(places)


SAMPLINGS: Final[Mapping[str, Sampling]] = MappingProxyType(
    {
        "smooth": Sampling(smooth=True),
        "fast": Sampling(),
        "careful": Sampling(jump_count=5),
        "plain": Sampling(jump_count=1),
    }
)
"""Settings by name: as fast as the release's fast one, but smoother where windows meet and with
poses as varied as the network's; the release's fast one; its careful one; no resampling."""

RELEASED_OVERLAP: Final = {"beat": 4, "show": 10}
"""Frames that the windows of the released networks share."""


STRIDE: Final = 10
"""Frames from one window to the next, as for BEAT in the release; for SHOW it is not known."""


@dataclass(frozen=True, kw_only=True)
class TrainingPreset(Preset):
    """Sizes and training of one network.

    Attributes
    ----------
    network : DenoiserConfig
        Its sizes; speakers are those of the takes.
    losses : str
        One of `generators.diffsheg.losses.LOSSES`.
    """

    network: DenoiserConfig
    losses: str


PRESETS: Final = read_presets(Path(__file__).with_name("presets.toml"), dict[str, TrainingPreset])
"""By config and data set."""

BEAT: Final = PRESETS["beat"]["beat"].network
SHOW: Final = PRESETS["show"]["show"].network

ABLATIONS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "naive_concat": {"flow": "joint"},
        "without_detach": {"detached": False},
        "without_x0": {"flow": "none"},
        "reverse": {"flow": "gesture_to_expression"},
    }
)
"""Changes of the network by the ablations of Table 1."""
