"""Components of face and body hold what belongs to them, and graphs join their neighbours."""

from __future__ import annotations

from typing import Final

import numpy as np

from motion.body.face_landmarks import FaceLandmarks
from training.spaces.anatomy import (
    BODY_PARTS,
    bone_graph,
    component_graph,
    components_of,
    face_graph,
    lips_of,
)

FACE: Final = FaceLandmarks.of_default_body()
COMPONENTS: Final = components_of(FACE.actions)


def test_landmarks_lie_in_four_components_of_which_the_lips_are_the_phonemes() -> None:
    eyes, nose, lips, jaw = COMPONENTS
    assert sorted((*eyes, *nose, *lips, *jaw)) == list(range(FACE.count))
    assert all(FACE.actions[one].startswith(("brow", "eye")) for one in eyes)
    corners = set(lips) - set(lips_of(FACE.actions))
    assert {FACE.actions[one][:9] for one in corners} >= {"mouthSmil", "mouthFrow"}


def test_graphs_join_what_the_paper_says() -> None:
    bones = bone_graph(2)
    assert bones[4, 5] == bones[3, 5] == 1  # upper arm and forearm; through a third bone
    assert bones[5, 8] == 0  # the two forearms
    components = component_graph(3, pose=True)
    assert components[0, 1] == components[0, 2] == 1
    assert components[1, 2] == 0
    assert component_graph(4, pose=False).sum() == 12
    face = face_graph(COMPONENTS, FACE.neutral)
    np.testing.assert_array_equal(face, face.T)
    eyes, _, lips, _ = COMPONENTS
    assert face[eyes[0], eyes[1]] == 1
    assert face[np.ix_(eyes, lips)].sum() == 1


def test_each_bone_belongs_to_one_part() -> None:
    assert sorted(bone for part in BODY_PARTS for bone in part) == list(range(9))
