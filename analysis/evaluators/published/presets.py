"""The published networks that can be loaded, and how their authors used each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analysis.evaluators.network_names import PUBLISHED
from analysis.evaluators.published import clip_inputs
from analysis.evaluators.published.published_distance import Rule
from motion.clip import MotionClip
from training.spaces.smplx_6d import rotation_rows

if TYPE_CHECKING:
    from torch import nn


@dataclass(frozen=True, kw_only=True)
class Preset:
    """One published network, and how its authors used it.

    Attributes
    ----------
    title : str
        What scores call it.
    source : str
        Whose code it follows: repository, commit and class.
    sees : str
        What a frame holds, in words.
    frames : callable
        Turns a clip at `frame_rate` into frames, shape (T, channels).
    channels, features : int
        Numbers of a frame, and of a row of features.
    frame_rate : float
        Frames per second.
    window, span, stride : int
        Frames of a window, frames that a clip must still have where one begins, and frames from
        one window to the next; a window of 0 is the whole clip.
    shortest : int
        Frames that the network needs at least.
    cut : str
        How windows are cut, in words.
    rule : {'pytorch-fid', 'offset'}
        How the published code takes the Fréchet distance.
    network : callable
        Makes the network, without its weights.
    place : tuple of str
        Keys of the checkpoint below which the weights lie.
    """

    title: str
    source: str
    sees: str
    frames: Callable[[MotionClip], NDArray[np.float64]]
    channels: int
    features: int
    frame_rate: float
    window: int = 0
    span: int = 0
    stride: int = 0
    shortest: int
    cut: str
    rule: Rule
    network: Callable[[], nn.Module]
    place: tuple[str, ...]


def _network(name: str, *sizes: object) -> nn.Module:
    # Imported here: torch takes seconds to load, and describing a network does without.
    from analysis.evaluators.published import networks

    made: nn.Module = getattr(networks, name)(*sizes)
    return made


PRESETS: Final[Mapping[str, Preset]] = MappingProxyType(
    {
        "emage": Preset(
            title=PUBLISHED["emage"],
            source="PantoMatrix 0bbb03d, VAESKConv (AESKConv_240_100.bin)",
            sees="55 SMPL-X joints, the first two rows of each rotation matrix, not normalised",
            frames=rotation_rows,
            channels=330,
            features=240,
            frame_rate=30.0,
            shortest=32,
            cut="the whole clip, without its last frames past a multiple of 32; a row of features "
            "for every 16 frames",
            rule="offset",
            network=partial(_network, "EmageNetwork"),
            place=("model_state",),
        ),
        "beat": Preset(
            title=PUBLISHED["beat"],
            source="beat2022dataset b6e5d80, HalfEmbeddingNet (ae_300.bin)",
            sees="47 joints of BEAT, XYZ Euler angles in degrees, in deviations of BEAT's frames",
            frames=clip_inputs.beat_frames,
            channels=141,
            features=300,
            frame_rate=15.0,
            window=34,
            span=34,
            stride=10,
            shortest=34,
            cut="34 frames, every 10 frames: neighbours overlap",
            rule="pytorch-fid",
            network=partial(_network, "YoonNetwork", 141, (300, 600, 600, 300), (1200, 600, 300)),
            place=("model_state",),
        ),
        "ted": Preset(
            title=PUBLISHED["ted"],
            source="ai4r f81004c, EmbeddingNet, mode pose",
            sees="directions of 9 bones of the upper body, less TED Gesture's mean",
            frames=clip_inputs.ted_frames,
            channels=27,
            features=32,
            frame_rate=15.0,
            window=34,
            span=42,
            stride=10,
            shortest=34,
            cut="the first 34 of 42 frames, every 10 frames: neighbours overlap; no window is "
            "filtered out",
            rule="pytorch-fid",
            network=partial(_network, "YoonNetwork", 27, (32, 64, 64, 32), (256, 128, 32)),
            place=("gen_dict",),
        ),
        "talkshow": Preset(
            title=PUBLISHED["talkshow"],
            source="TalkSHOW 9aef82d, body autoencoder (feature_extractor.pth)",
            sees="43 SMPL-X joints, axis-angle, fingers against the mean hands, not normalised",
            frames=clip_inputs.talkshow_frames,
            channels=129,
            features=64,
            frame_rate=30.0,
            shortest=4,
            cut="the whole clip; a row of features for every 4 frames",
            rule="pytorch-fid",
            network=partial(_network, "TalkShowNetwork"),
            place=("generator", "g"),
        ),
    }
)
"""By name."""
