"""What metrics keep is used for as long as its version is the same, which must be true."""

import numpy as np
import pytest
from numpy.typing import NDArray

from analysis.evaluators.clip_views import Channels
from analysis.evaluators.evaluator import Evaluator, EvaluatorFacts, Normalisation
from analysis.evaluators.training import PRESETS
from analysis.measurement import measured_clips
from analysis.metrics.kinematics import joint_motion
from analysis.metrics.self_penetration import PenetrableBody
from motion.arrays import Floats32
from motion.audio_analysis import speech_onsets
from motion.body.face_landmarks import FaceLandmarks
from motion.body.model import read_body
from motion.clip import MotionClip
from motion.segment import EMOTIONS
from motion.skeleton import joint_index
from renderer.look import default_body
from tests.generators.conftest import syllables
from tests.generators.reference_weights import reference_weights
from tests.motion.random_clips import clip_of
from tests.support.fingerprint import fingerprint

# After an intended change, raise the version in the module and update the numbers here.
JOINTS = {"joints-1": [-0.7307, 0.09075]}
ONSETS = {"onsets-2": [-3.59122]}
FEATURES = {
    "features-1": {"gesture": [-0.016127], "body": [0.174932, -0.160979], "both": [0.005965]}
}
LANDMARKS = {"landmarks-1": [0.006724]}
DEPTHS = {"depths-1": [-0.041798]}


def moving(count: int = 120) -> MotionClip:
    frames = np.arange(count)
    waves = np.sin(frames[:, None, None] / 9 + np.arange(165).reshape(55, 3)) / 5
    arkit = np.abs(np.sin(frames[:, None] / 7 + np.arange(52))) / 2
    return clip_of(waves, waves[:, 0], 25, arkit=arkit)


def network(kind: str, channels: Channels) -> Evaluator:
    """Return a network of seeded weights, which no training changes."""
    facts = EvaluatorFacts(
        channels=channels,
        network=PRESETS[kind]["tiny"].network,
        face="arkit" if channels == "both" else None,
        labels=EMOTIONS if kind == "emotion" else (),
        frozen=(),
    )
    width = facts.view().channels
    made = facts.fresh_network(width)
    shapes = {name: list(weight.shape) for name, weight in made.state_dict().items()}
    made.load_state_dict(reference_weights(shapes))
    normalisation = Normalisation(
        mean=np.linspace(-0.1, 0.1, width, dtype=np.float32),
        deviation=np.linspace(0.5, 1.5, width, dtype=np.float32),
    )
    return Evaluator(facts=facts, network=made.eval(), normalisation=normalisation, landmarks=None)


def depths_of_arms() -> Floats32:
    poses = np.zeros((40, 55, 3))
    poses[:, joint_index("left_shoulder"), 2] = -np.linspace(1.2, 1.8, 40)
    body = PenetrableBody.of(read_body(default_body("mannequin")))
    depths = body.depths(clip_of(poses, frame_rate=10))
    assert depths.max() > 0.01
    return depths


def landmarks() -> NDArray[np.floating]:
    face = FaceLandmarks.of(read_body(default_body()))
    return face.positions(moving().frames(slice(0, 30)))


def test_changed_cached_values_require_a_new_version() -> None:
    joints = joint_motion(moving(40), 30)
    for arrays, kind, expected in (
        ((joints.relative, joints.pelvis), measured_clips.JOINTS, JOINTS),
        ((speech_onsets(syllables(6.0, 1)),), measured_clips.ONSETS, ONSETS),
        ((landmarks(),), measured_clips.LANDMARKS, LANDMARKS),
        ((depths_of_arms(),), measured_clips.DEPTHS, DEPTHS),
    ):
        assert fingerprint(*arrays) == pytest.approx(expected[kind], abs=1e-5), kind


@pytest.mark.parametrize(
    ("kind", "channels"), [("motion", "gesture"), ("emotion", "body"), ("motion", "both")]
)
def test_changed_network_features_require_a_new_version(kind: str, channels: Channels) -> None:
    evaluator = network(kind, channels)
    arrays = [evaluator.embed(moving())]
    if evaluator.labels:
        arrays.append(evaluator.classify(moving()))
    expected = FEATURES[measured_clips.FEATURES][channels]
    assert fingerprint(*arrays) == pytest.approx(expected, abs=1e-5)
