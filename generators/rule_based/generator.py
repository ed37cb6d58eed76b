"""The rule-based generator, from its parts."""

import numpy as np

from generators.interface import ClipRequest, Generator, seeded_stream
from generators.rule_based.body_pose import pose_body
from generators.rule_based.face_motion import move_face
from generators.rule_based.hand_tracks import move_hands
from generators.rule_based.posture import move_trunk
from generators.rule_based.vocabulary import STYLES
from motion.clip import MotionClip
from motion.prosody import prosody


class RuleBased(Generator):
    """Beat gestures, posture and face from the speech's own energy and pitch."""

    name = "rule_based"
    version = "3"

    def make_clip(self, request: ClipRequest) -> MotionClip:
        """Return gestures, posture and face."""
        segment, audio, rate = request.speech.segment, request.speech.audio, request.frame_rate
        times = np.arange(request.frames) / rate
        style = STYLES[segment.emotion]
        speech_prosody = prosody(audio, rate)
        rng = np.random.default_rng(seeded_stream(request.seed, self.name, segment.name))
        hands = move_hands(style, speech_prosody, times, rng)
        trunk = move_trunk(style, speech_prosody, hands, times, rng)
        poses, trans = pose_body(trunk, hands)
        head_in_world = trunk.pelvis + trunk.spine + trunk.head
        arkit = move_face(style, audio, speech_prosody, head_in_world, times, rng)
        return MotionClip(
            poses=poses.astype(np.float32),
            trans=trans.astype(np.float32),
            frame_rate=rate,
            arkit=arkit.astype(np.float32),
            provenance={"emotion": segment.emotion},
        )
