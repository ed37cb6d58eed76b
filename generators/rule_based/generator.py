"""The rule-based generator, from its parts."""

from __future__ import annotations

from typing import Final

import numpy as np

from generators.interface import (
    OnPart,
    SpeechSegment,
    StudyClips,
    ignore_progress,
    provenance_of,
    seeded_stream,
)
from generators.rule_based.body_pose import pose_body
from generators.rule_based.face_motion import move_face
from generators.rule_based.hand_tracks import move_hands
from generators.rule_based.posture import move_trunk
from generators.rule_based.vocabulary import STYLES
from motion.clip import MotionClip
from motion.prosody import prosody


class RuleBased:
    """Beat gestures, posture and face from the speech's own energy and pitch."""

    name: Final = "rule_based"
    version: Final = "3"

    def generate(
        self,
        speech: SpeechSegment,
        *,
        seed: int,
        frame_rate: float,
        source: StudyClips | None = None,
        on_part: OnPart = ignore_progress,
    ) -> MotionClip:
        """Return motion to `speech`; see `generators.interface.Generator.generate`."""
        frames = speech.frame_count(frame_rate)
        times = np.arange(frames) / frame_rate
        style = STYLES[speech.segment.emotion]
        speech_prosody = prosody(speech.audio, frame_rate)
        rng = np.random.default_rng(seeded_stream(seed, self.name, speech.segment.name))
        hands = move_hands(style, speech_prosody, times, rng)
        trunk = move_trunk(style, speech_prosody, hands, times, rng)
        poses, trans = pose_body(trunk, hands)
        head_in_world = trunk.pelvis + trunk.spine + trunk.head
        arkit = move_face(style, speech.audio, speech_prosody, head_in_world, times, rng)
        return MotionClip(
            poses=poses.astype(np.float32),
            trans=trans.astype(np.float32),
            frame_rate=frame_rate,
            arkit=arkit.astype(np.float32),
            provenance={
                **provenance_of(self.name, seed, speech),
                "emotion": speech.segment.emotion,
            },
        )
