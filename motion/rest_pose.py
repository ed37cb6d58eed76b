"""Where the default body's joints are when nothing is posed.

Taken from the body that `renderer.body_asset` freezes (a test holds the two together), so that
importing or generating motion needs no mesh.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

REST_JOINTS: Final[NDArray[np.float64]] = np.array(
    [
        (0.0000, -0.3500, 0.0100),  # pelvis
        (0.1121, -0.4350, 0.0200),  # left_hip
        (-0.1121, -0.4350, 0.0200),  # right_hip
        (0.0000, -0.2322, 0.0043),  # spine1
        (0.1220, -0.8574, 0.0526),  # left_knee
        (-0.1220, -0.8574, 0.0526),  # right_knee
        (0.0000, -0.1425, -0.0052),  # spine2
        (0.1425, -1.2849, 0.0265),  # left_ankle
        (-0.1425, -1.2849, 0.0265),  # right_ankle
        (0.0000, -0.0450, -0.0107),  # spine3
        (0.1414, -1.3203, 0.0918),  # left_foot
        (-0.1414, -1.3203, 0.0918),  # right_foot
        (0.0000, 0.1289, 0.0319),  # neck
        (0.0226, 0.0552, 0.0463),  # left_collar
        (-0.0226, 0.0552, 0.0463),  # right_collar
        (0.0000, 0.2263, 0.0649),  # head
        (0.1783, 0.0497, 0.0406),  # left_shoulder
        (-0.1783, 0.0497, 0.0406),  # right_shoulder
        (0.4483, 0.0497, 0.0406),  # left_elbow
        (-0.4483, 0.0497, 0.0406),  # right_elbow
        (0.6993, 0.0497, 0.0406),  # left_wrist
        (-0.6993, 0.0497, 0.0406),  # right_wrist
        (0.0000, 0.2329, 0.0802),  # jaw
        (0.0293, 0.2659, 0.1454),  # left_eye
        (-0.0293, 0.2659, 0.1454),  # right_eye
        (0.8091, 0.0453, 0.0681),  # left_index1
        (0.8364, 0.0453, 0.0701),  # left_index2
        (0.8609, 0.0453, 0.0719),  # left_index3
        (0.8082, 0.0497, 0.0406),  # left_middle1
        (0.8438, 0.0497, 0.0381),  # left_middle2
        (0.8727, 0.0497, 0.0360),  # left_middle3
        (0.7919, 0.0453, 0.0004),  # left_pinky1
        (0.8140, 0.0453, -0.0045),  # left_pinky2
        (0.8300, 0.0453, -0.0081),  # left_pinky3
        (0.8020, 0.0502, 0.0200),  # left_ring1
        (0.8330, 0.0502, 0.0150),  # left_ring2
        (0.8589, 0.0502, 0.0108),  # left_ring3
        (0.7395, 0.0458, 0.0663),  # left_thumb1
        (0.7518, 0.0239, 0.0869),  # left_thumb2
        (0.7787, 0.0051, 0.1070),  # left_thumb3
        (-0.8091, 0.0453, 0.0681),  # right_index1
        (-0.8364, 0.0453, 0.0701),  # right_index2
        (-0.8609, 0.0453, 0.0719),  # right_index3
        (-0.8082, 0.0497, 0.0406),  # right_middle1
        (-0.8438, 0.0497, 0.0381),  # right_middle2
        (-0.8727, 0.0497, 0.0360),  # right_middle3
        (-0.7919, 0.0453, 0.0004),  # right_pinky1
        (-0.8140, 0.0453, -0.0045),  # right_pinky2
        (-0.8300, 0.0453, -0.0081),  # right_pinky3
        (-0.8020, 0.0502, 0.0200),  # right_ring1
        (-0.8330, 0.0502, 0.0150),  # right_ring2
        (-0.8589, 0.0502, 0.0108),  # right_ring3
        (-0.7395, 0.0458, 0.0663),  # right_thumb1
        (-0.7518, 0.0239, 0.0869),  # right_thumb2
        (-0.7787, 0.0051, 0.1070),  # right_thumb3
    ]
)
"""Shape (55, 3), metres: T-pose, palms down, y up, facing +z, left at +x."""

REST_JOINTS.setflags(write=False)
