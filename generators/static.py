"""A calm, neutral stance held perfectly still: the least that a condition can do."""

from __future__ import annotations

from typing import Final

import numpy as np

from generators.interface import OnPart, SpeechSegment, StudyClips, seeded_stream, unheard
from generators.rule_based.body_pose import Trunk, pose_body
from generators.rule_based.hand_pose import BY_THE_SIDE
from motion.clip import MotionClip
from motion.face import ARKIT_NAMES


class Static:
    """Stands with the arms down and a neutral face; nothing moves."""

    name: Final = "static"
    version: Final = "1"
    needs_source: Final = False

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

        Every seed gives the same stance: nothing in it is random.
        """
        seeded_stream(seed)
        frames = speech.frame_count(frame_rate)
        still, level = np.zeros((1, 3)), np.zeros(1)
        trunk = Trunk(
            pelvis=still,
            spine=still,
            head=still,
            shift=still,
            shoulders_up=level,
            shoulders_forward=level,
        )
        hand = BY_THE_SIDE.channels()[None]
        poses, trans = pose_body(trunk, {"left": hand, "right": hand})
        return MotionClip(
            poses=np.repeat(poses, frames, axis=0).astype(np.float32),
            trans=np.repeat(trans, frames, axis=0).astype(np.float32),
            frame_rate=frame_rate,
            arkit=np.zeros((frames, len(ARKIT_NAMES)), np.float32),
            provenance={
                "generator": self.name,
                "seed": str(seed),
                "segment": speech.segment.name,
            },
        )
