"""Sizes of DiffSHEG networks, and their default training."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final, Literal

from training.config import Preset, read_presets
from training.diffusion import LINEAR

Flow = Literal["expression_to_gesture", "gesture_to_expression", "none", "joint"]
"""Direction of conditioning between the branches: see `DenoiserConfig.flow`."""

Loudness = Literal["power", "logarithm"]
"""Scale of the mel bands: see `DenoiserConfig.loudness`."""

CLEAN: Final = -1
"""The place of a walk at which no noise is left."""

JUMP_LENGTH: Final = 3
"""Steps of noise that resampling adds at once."""

BLEND_BELOW: Final = 0.2
"""Standard deviation of the remaining noise below which shared frames blend linearly into the new
window; above it, they are the previous window's."""

JOINT_WIDENING: Final = 1.41
"""Ratio of widths at which the single branch of 'joint' costs as much as two (section 4.5)."""


@dataclass(frozen=True, kw_only=True)
class DenoiserConfig:
    """Sizes of a denoiser, and the ablations of the paper's Table 1 as switches.

    Attributes
    ----------
    gesture_width, expression_width : int
        Numbers of values of body and face in a frame; the body's values come first.
    speakers : int
        Length of the speaker's one-hot vector.
    frames : int
        Frames of the windows it is trained on.
    frame_rate : float
        Frames per second.
    width, feed_forward, heads, layers : int
        Sizes of the transformer of each branch.
    audio_width, speech_width : int
        Number of mel bands, which is also the width of the shared encoder's output; width of each
        branch's encoding of the speech features.
    speech_features : int
        Channels of the speech features (HuBERT).
    dropout : float
        Dropout in training, in [0, 1).
    longest : int
        Number of frame positions.
    flow : {'expression_to_gesture', 'gesture_to_expression', 'none', 'joint'}
        Which branch gets the other's estimate of the clean motion: as in the paper; the
        other way round ('Reverse Direction'); none ('w/o x̂0'); or a single, wider branch for body
        and face together ('Naive Concat').
    detached : bool
        Whether gradients stop at that estimate; False is 'w/o Detach'.
    guidance : float or None
        Scale of classifier-free guidance, 1 for no effect (Ho & Salimans 2021), as in the release
        for SHOW. None for a network without an unconditional estimate.
    loudness : {'power', 'logarithm'}
        Scale of the mel bands: power, as in the release, which spans nine decades and is almost
        zero except in the loudest moments; or its logarithm, scaled to about -1 to 3.
    skip : bool
        Whether the part of the noise that follows from the covariance of the training motion
        bypasses the layers of each branch: see `generators.diffsheg.layers.LinearSkip`. Without a
        skip, as in the paper, all noise passes through the layers, and a branch that is narrower
        than its part of the motion loses some of it.
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
        """Number of values in a frame."""
        return self.gesture_width + self.expression_width

    @property
    def style_width(self) -> int:
        """Width of the style, which encodes diffusion step and speaker."""
        return 4 * self.width

    @property
    def joint_width(self) -> int:
        """Width of the single branch of 'joint', divisible by twice its heads."""
        step = 2 * self.heads
        return step * round(self.width * JOINT_WIDENING / step)


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """Sampling of windows: fast outpainting-based partial autoregressive sampling.

    FOPPAS (section 3.5) is DDIM instead of DDPM, with RePaint's resampling for windows that
    continue another one.

    Attributes
    ----------
    steps : int
        Number of DDIM steps from pure noise to a clean window.
    overlap : int
        Frames that a window shares with the previous one.
    jump_count : int
        Number of times that each stretch of `JUMP_LENGTH` steps is walked: 1 for no resampling, 2
        in the release's fast setting, 5 in its careful one.
    smooth : bool
        Whether a window that continues another one starts from noise around the last known pose,
        and its shared frames keep the noise that the network predicts. The release starts from pure
        noise, although 4% of the motion's variance should be left at that step: slow components of
        the motion fade from window to window. The release and RePaint give shared frames new noise
        at each step, which is inconsistent with the new frames.
    """

    steps: int = 25
    overlap: int = 4
    jump_count: int = 2
    smooth: bool = False

    @property
    def entry(self) -> int:
        """Number of steps of a window that continues another one: 15 of the paper's 25."""
        return max(1, round(0.6 * self.steps))

    @cached_property
    def timesteps(self) -> tuple[int, ...]:
        """The diffusion step at each place, from the least noise to the most."""
        return tuple(range(0, LINEAR.steps, LINEAR.steps // self.steps))

    @cached_property
    def first_walk(self) -> tuple[int, ...]:
        """Places of the first window's walk, down to `CLEAN`."""
        return (*range(self.steps - 1, -1, -1), CLEAN)

    @cached_property
    def later_walk(self) -> tuple[int, ...]:
        """Places of the walk of a window that continues another one, down to `CLEAN`.

        Lugmayr et al. 2022 (RePaint), Figure 9: each stretch of `JUMP_LENGTH` steps is walked
        `jump_count` times, with noise added in between.
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


SAMPLINGS: Final[Mapping[str, Sampling]] = {
    "smooth": Sampling(smooth=True),
    "fast": Sampling(),
    "careful": Sampling(jump_count=5),
    "plain": Sampling(jump_count=1),
}
"""Settings by name: as fast as the release's fast one, but smoother between windows and with poses
as varied as the network's; the release's fast one; its careful one; no resampling."""

RELEASED_OVERLAP: Final = {"beat": 4, "show": 10}
"""Frames that windows of the released networks share."""

STRIDE: Final = 10
"""Frames from one training window to the next, as in the release for BEAT; unknown for SHOW."""


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
"""Presets by config and data set."""

BEAT: Final = PRESETS["beat"]["beat"].network
SHOW: Final = PRESETS["show"]["show"].network

ABLATIONS: Final[Mapping[str, Mapping[str, Any]]] = {
    "naive_concat": {"flow": "joint"},
    "without_detach": {"detached": False},
    "without_x0": {"flow": "none"},
    "reverse": {"flow": "gesture_to_expression"},
}
"""Changes of the network by the ablations of Table 1."""
