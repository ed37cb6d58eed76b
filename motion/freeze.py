"""Holding channels of a clip still, so that what a condition lacks does not give it away."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from types import MappingProxyType
from typing import Final

import numpy as np

from motion.clip import MotionClip
from motion.errors import InputError
from motion.hands import FINGERS, RELAXED_HANDS
from motion.skeleton import FACE_JOINTS, LEFT_HAND_JOINTS, RIGHT_HAND_JOINTS, joint_index

_LEGS: Final = ("hip", "knee", "ankle", "foot")
_JOINTS_OF_CHANNEL: Final = MappingProxyType(
    {
        "face": FACE_JOINTS,
        "hands": (*LEFT_HAND_JOINTS, *RIGHT_HAND_JOINTS),
        "lower_body": tuple(f"{side}_{part}" for part in _LEGS for side in ("left", "right")),
        "root": ("pelvis",),
    }
)
CHANNELS: Final = tuple(_JOINTS_OF_CHANNEL)

_TURNS: Final = 0.02
"""Radians that a joint turns at least where it can be seen to move."""

_SHIFTS: Final = 0.005
"""Metres, of the root."""

_FACIAL: Final = 0.05
"""Of a facial action's weight or an expression's coefficient."""


def freeze(clip: MotionClip, channels: Collection[str]) -> MotionClip:
    """Return `clip` with `channels` held at neutral values in every frame.

    Parameters
    ----------
    clip : MotionClip
        The motion.
    channels : collection of str
        Any of `CHANNELS`. ``face``: jaw, eyes, expressions and ARKit weights are zero.
        ``hands``: fingers are relaxed. ``lower_body``: legs are straight. ``root``:
        the pelvis stays at the origin and faces +z.

    Raises
    ------
    InputError
        If a channel is unknown.
    """
    unknown = sorted(set(channels) - set(CHANNELS))
    if unknown:
        raise InputError(
            f"unknown channel {unknown[0]!r} to freeze", remedy=f"Use any of {', '.join(CHANNELS)}"
        )
    poses = clip.poses.copy()
    for channel in channels:
        poses[:, [joint_index(name) for name in _JOINTS_OF_CHANNEL[channel]]] = 0
    if "hands" in channels:
        poses[:, FINGERS] = RELAXED_HANDS
    frozen = replace(clip, poses=poses)
    if "root" in channels:
        frozen = replace(frozen, trans=np.zeros_like(clip.trans))
    if "face" in channels:
        frozen = replace(
            frozen,
            expressions=None if clip.expressions is None else np.zeros_like(clip.expressions),
            arkit=None if clip.arkit is None else np.zeros_like(clip.arkit),
        )
    return frozen


def moving_channels(clip: MotionClip) -> frozenset[str]:
    """Return the channels of `clip` that can be seen to move."""
    seen = {
        name: [np.ptp(clip.poses[:, [joint_index(joint) for joint in joints]], axis=0) > _TURNS]
        for name, joints in _JOINTS_OF_CHANNEL.items()
    }
    seen["root"].append(np.ptp(clip.trans, axis=0) > _SHIFTS)
    facial = (value for value in (clip.expressions, clip.arkit) if value is not None)
    seen["face"].extend(np.ptp(value, axis=0) > _FACIAL for value in facial)
    return frozenset(name for name, parts in seen.items() if any(part.any() for part in parts))
