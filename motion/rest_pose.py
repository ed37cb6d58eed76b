"""Where the default body's joints are when nothing is posed.

Taken from the body that `renderer.avatars` freezes (a test holds the two together), so that
importing or generating motion needs no mesh.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

REST_JOINTS: Final[NDArray[np.float64]] = np.array(
    [
        (0.0000, -0.3500, 0.0100),  # pelvis
        (0.1127, -0.4350, 0.0200),  # left_hip
        (-0.1127, -0.4350, 0.0200),  # right_hip
        (0.0000, -0.2312, 0.0042),  # spine1
        (0.1226, -0.8595, 0.0528),  # left_knee
        (-0.1226, -0.8595, 0.0528),  # right_knee
        (0.0000, -0.1410, -0.0053),  # spine2
        (0.1432, -1.2890, 0.0266),  # left_ankle
        (-0.1432, -1.2890, 0.0266),  # right_ankle
        (0.0000, -0.0431, -0.0109),  # spine3
        (0.1421, -1.3246, 0.0922),  # left_foot
        (-0.1421, -1.3246, 0.0922),  # right_foot
        (0.0000, 0.1316, 0.0320),  # neck
        (0.0227, 0.0576, 0.0464),  # left_collar
        (-0.0227, 0.0576, 0.0464),  # right_collar
        (0.0000, 0.2295, 0.0652),  # head
        (0.1792, 0.0521, 0.0407),  # left_shoulder
        (-0.1792, 0.0521, 0.0407),  # right_shoulder
        (0.4505, 0.0521, 0.0407),  # left_elbow
        (-0.4505, 0.0521, 0.0407),  # right_elbow
        (0.7027, 0.0521, 0.0407),  # left_wrist
        (-0.7027, 0.0521, 0.0407),  # right_wrist
        (0.0000, 0.2362, 0.0805),  # jaw
        (0.0294, 0.2693, 0.1461),  # left_eye
        (-0.0294, 0.2693, 0.1461),  # right_eye
        (0.8131, 0.0476, 0.0683),  # left_index1
        (0.8405, 0.0476, 0.0703),  # left_index2
        (0.8651, 0.0476, 0.0722),  # left_index3
        (0.8122, 0.0521, 0.0407),  # left_middle1
        (0.8480, 0.0521, 0.0381),  # left_middle2
        (0.8770, 0.0521, 0.0361),  # left_middle3
        (0.7958, 0.0476, 0.0003),  # left_pinky1
        (0.8180, 0.0476, -0.0046),  # left_pinky2
        (0.8341, 0.0476, -0.0082),  # left_pinky3
        (0.8059, 0.0526, 0.0200),  # left_ring1
        (0.8371, 0.0526, 0.0150),  # left_ring2
        (0.8631, 0.0526, 0.0108),  # left_ring3
        (0.7431, 0.0481, 0.0665),  # left_thumb1
        (0.7554, 0.0262, 0.0872),  # left_thumb2
        (0.7826, 0.0073, 0.1075),  # left_thumb3
        (-0.8131, 0.0476, 0.0683),  # right_index1
        (-0.8405, 0.0476, 0.0703),  # right_index2
        (-0.8651, 0.0476, 0.0722),  # right_index3
        (-0.8122, 0.0521, 0.0407),  # right_middle1
        (-0.8480, 0.0521, 0.0381),  # right_middle2
        (-0.8770, 0.0521, 0.0361),  # right_middle3
        (-0.7958, 0.0476, 0.0003),  # right_pinky1
        (-0.8180, 0.0476, -0.0046),  # right_pinky2
        (-0.8341, 0.0476, -0.0082),  # right_pinky3
        (-0.8059, 0.0526, 0.0200),  # right_ring1
        (-0.8371, 0.0526, 0.0150),  # right_ring2
        (-0.8631, 0.0526, 0.0108),  # right_ring3
        (-0.7431, 0.0481, 0.0665),  # right_thumb1
        (-0.7554, 0.0262, 0.0872),  # right_thumb2
        (-0.7826, 0.0073, 0.1075),  # right_thumb3
    ]
)
"""Shape (55, 3), metres: T-pose, palms down, y up, facing +z, left at +x."""

REST_JOINTS.setflags(write=False)
