"""Right motion, wrong speech: what the same condition does to another segment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from generators.clip_length import with_length
from generators.interface import (
    OnPart,
    SpeechSegment,
    StudyClips,
    required_source,
    seeded_stream,
    unheard,
)
from motion.clip import MotionClip
from motion.errors import InputError
from motion.resample import resample
from motion.segment import Segment

_COST_OF_MISSING_SECOND: Final = 4.0
_COST_OF_OWN_MOTION: Final = 1e9


class Mismatched:
    """Gives each segment the source condition's clip of another segment."""

    name: Final = "mismatched"
    version: Final = "1"
    needs_source: Final = True

    def generate(
        self,
        speech: SpeechSegment,
        *,
        seed: int,
        frame_rate: float,
        source: StudyClips | None = None,
        on_part: OnPart = unheard,
    ) -> MotionClip:
        """Return motion to `speech`; see `generators.interface.Generator.generate`.

        A clip that is too short goes on by running backwards from its last frame, so that
        nothing jumps; the provenance then says so.
        """
        clips = required_source(source, self.name)
        partner = _partner(speech.segment, clips.segments, seed)
        clip = resample(clips.clip(partner), frame_rate)
        frames = speech.frame_count(frame_rate)
        return with_length(clip, frames).with_provenance(
            generator=self.name,
            seed=str(seed),
            segment=speech.segment.name,
            motion_of_segment=partner,
            continued_by_reversal=str(frames > len(clip)).lower(),
        )


def partners(segments: Sequence[Segment], seed: int) -> Mapping[str, str]:
    """Return for each segment of a study the one whose motion it gets.

    Nobody keeps their own motion and no two get the same: of all such exchanges, one that has
    few seconds missing where a partner is shorter, and among equals a random one. (The optimal
    assignment of Kuhn 1955, with random costs for the choice among equals.)

    Parameters
    ----------
    segments : sequence of Segment
        All of the study, in any order.
    seed : int
        Not negative.

    Raises
    ------
    InputError
        If there are fewer than two segments.
    """
    if len(segments) < 2:
        raise InputError(
            "mismatched motion needs the motion of another segment, and the study has "
            f"{len(segments)}",
            remedy="Add a second segment, or leave this condition out",
        )
    ordered = sorted(segments, key=lambda segment: segment.name)
    length = np.array([segment.duration for segment in ordered])
    missing = np.maximum(length[:, None] - length[None, :], 0)
    chance = np.random.default_rng(seeded_stream(seed, Mismatched.name)).random(missing.shape)
    cost = chance + _COST_OF_MISSING_SECOND * missing
    np.fill_diagonal(cost, _COST_OF_OWN_MOTION)
    takers, givers = linear_sum_assignment(cost)
    return {
        ordered[taker].name: ordered[giver].name
        for taker, giver in zip(takers, givers, strict=True)
    }


def _partner(segment: Segment, segments: Sequence[Segment], seed: int) -> str:
    chosen = partners(segments, seed)
    if segment.name not in chosen:
        raise InputError(
            f"segment {segment.name} is none of the study's",
            remedy=f"Use one of {', '.join(sorted(chosen))}",
        )
    return chosen[segment.name]
