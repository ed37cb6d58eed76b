"""What a DiffSHEG network is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from motion.errors import InputError

Flow = Literal["expression_to_gesture", "gesture_to_expression", "none", "joint"]
"""What is told to what: see `DenoiserConfig.flow`."""

FLOWS: Final[tuple[Flow, ...]] = ("expression_to_gesture", "gesture_to_expression", "none", "joint")

Loudness = Literal["power", "logarithm"]
"""How mel bands are read: see `DenoiserConfig.loudness`."""

LOUDNESSES: Final[tuple[Loudness, ...]] = ("power", "logarithm")

JOINT_WIDENING: Final = 1.41
"""How much wider the one branch of 'joint' is, so that it costs as much as two (section 4.5)."""


@dataclass(frozen=True, kw_only=True)
class DenoiserConfig:
    """Sizes of a denoiser, and the ablations of the paper's Table 1 as switches.

    Attributes
    ----------
    gesture_width, expression_width : int
        Values of body and of face in a frame; a frame is the body's, then the face's.
    speakers : int
        Length of the one-hot vector that tells who speaks.
    frames : int
        Frames of the windows it is trained on.
    frame_rate : float
        Frames per second.
    width, feed_forward, heads, layers : int
        Of the transformer of each branch.
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
        Which branch is told the other's estimate of the clean motion: as the paper has it; the
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
        the layers of each branch: see `generators.diffsheg.linear_skip`. Without, as the paper has
        it, all noise passes through them, and a branch narrower than its part of the motion loses
        some of it on the way.
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

    def __post_init__(self) -> None:
        sizes = {
            name: getattr(self, name)
            for name in (
                *("gesture_width", "expression_width", "speakers", "frames", "width", "heads"),
                *("feed_forward", "layers", "audio_width", "speech_width", "speech_features"),
            )
        }
        for name, size in sizes.items():
            if size < 1:
                raise _unusable(f"{name} is {size}", "Give at least 1")
        if self.width % (2 * self.heads) or self.audio_width % self.heads:
            raise _unusable(
                f"{self.heads} heads do not divide a width of {self.width} and {self.audio_width}",
                "Let the heads divide both widths, and the first be even",
            )
        if self.frames > self.longest:
            raise _unusable(
                f"windows of {self.frames} frames are longer than the {self.longest} positions",
                "Give more positions or shorter windows",
            )
        if not 0 <= self.dropout < 1:
            raise _unusable(f"dropout is {self.dropout}", "Give a share below 1")
        if not self.frame_rate > 0:
            raise _unusable(f"the frame rate is {self.frame_rate}", "Give a rate above 0")
        if self.flow not in FLOWS:
            raise _unusable(f"there is no flow {self.flow!r}", f"Use one of {', '.join(FLOWS)}")

        if self.loudness not in LOUDNESSES:
            raise _unusable(
                f"there is no loudness {self.loudness!r}", f"Use one of {', '.join(LOUDNESSES)}"
            )

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


def _unusable(what: str, remedy: str) -> InputError:
    return InputError(f"this is no DiffSHEG network: {what}", remedy=remedy)


BEAT: Final = DenoiserConfig(
    gesture_width=141, expression_width=51, speakers=30, frames=34, frame_rate=15.0
)
"""47 joints as axis-angle and 51 ARKit weights, normalised."""

SHOW: Final = DenoiserConfig(
    gesture_width=129,
    expression_width=103,
    speakers=4,
    frames=88,
    frame_rate=30.0,
    guidance=1.15,
)
"""43 joints as axis-angle; jaw and 100 SMPL-X expression coefficients, normalised."""

TINY: Final = DenoiserConfig(
    gesture_width=141,
    expression_width=51,
    speakers=30,
    frames=34,
    frame_rate=15.0,
    width=64,
    feed_forward=128,
    heads=4,
    layers=2,
    speech_width=64,
    dropout=0.0,
    guidance=2.0,
    loudness="logarithm",
    skip=True,
)
"""BEAT's motion in a network that a CPU trains in minutes. It is narrower than the motion and
learns from little speech, so it has a skip, hears logarithms and is driven by twice what the speech
changes."""

CONFIGS: Final[Mapping[str, DenoiserConfig]] = MappingProxyType(
    {"beat": BEAT, "show": SHOW, "tiny": TINY}
)
