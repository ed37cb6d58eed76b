from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.rendering.sample_motion import gesturing_clip
from motion.arrays import Floats, Indices
from motion.body.face_landmarks import landmark_vertices
from motion.body.model import BodyModel
from motion.clip import MotionClip, arkit_index
from motion.points.detection import Detection, stretches
from motion.points.found_motion import clip_from_detection
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from tests.motion.random_clips import arkit_of, joint_positions, largest_angle

FRAMES = 150
JAW = arkit_index("jawOpen")
BLINK = arkit_index("eyeBlinkLeft")


def talking() -> MotionClip:
    """Return a clip of a face that opens its mouth and blinks, and of moving arms."""
    time = np.arange(FRAMES) / 30
    arkit = np.zeros((FRAMES, 52), np.float32)
    arkit[:, JAW] = 0.35 - 0.35 * np.cos(5 * time)
    arkit[:, BLINK] = arkit[:, arkit_index("eyeBlinkRight")] = time % 2 < 0.2
    return replace(gesturing_clip(5, 30), arkit=arkit)


def pose_of(clip: MotionClip) -> Floats:
    """Return the detected pose as seen by a tilted camera."""
    at, turns = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    pose = np.zeros((FRAMES, 33, 3))
    head, rotations = at[:, joint_index("head")], turns[:, joint_index("head")]
    for place, offset in {0: (0, 0.026, 0.12), 7: (0.08, 0.05, 0), 8: (-0.08, 0.05, 0)}.items():
        pose[:, place] = head + rotations @ np.array(offset)
    limbs = ("shoulder", "elbow", "wrist", "pinky1", "index1", "thumb1", "hip", "knee", "ankle")
    names = [f"{side}_{part}" for part in limbs for side in ("left", "right")]
    pose[:, 11:29] = at[:, [joint_index(name) for name in names]]
    camera = Rotation.from_euler("xy", [185, 15], degrees=True)
    return np.asarray(pose @ camera.as_matrix().T)


def face_of(clip: MotionClip, body: BodyModel) -> Floats:
    """Return a face mesh of points on the body's face, as seen by a moving camera."""
    still = replace(clip, poses=0 * clip.poses)
    vertices = body.vertices(still).astype(float)
    names = [str(name) for name in body.surface["material_names"]]
    material = body.surface["material"]
    skin = np.flatnonzero(np.isin(material, [names.index("skin"), names.index("lips")]))
    skin = skin[body.template[skin, 1] > 0.15]
    skin = skin[body.template[skin, 2] > 0.1]
    chosen = np.random.default_rng(0).choice(skin, 478)
    landmarks = landmark_vertices(body)
    chosen[400 : 400 + len(landmarks)] = landmarks

    def nearest(place: tuple[float, float, float], among: Indices = skin) -> int:
        return int(among[np.linalg.norm(body.template[among] - place, axis=1).argmin()])

    lips = np.flatnonzero(material == names.index("lips"))
    for sign, inner, outer, upper, lower in ((1, 362, 263, 386, 374), (-1, 133, 33, 159, 145)):
        chosen[inner] = nearest((sign * 0.015, 0.269, 0.158))
        chosen[outer] = nearest((sign * 0.043, 0.269, 0.158))
        chosen[upper] = nearest((sign * 0.03, 0.275, 0.165))
        chosen[lower] = nearest((sign * 0.03, 0.262, 0.162))
    chosen[1] = nearest((0, 0.2276, 0.1876))
    chosen[291] = lips[body.template[lips, 0].argmax()]
    chosen[61] = lips[body.template[lips, 0].argmin()]
    chosen[13], chosen[14] = nearest((0, 0.2035, 0.18), lips), nearest((0, 0.197, 0.178), lips)
    for place, at in {
        10: (0, 0.36, 0.15), 151: (0, 0.33, 0.16), 9: (0, 0.31, 0.165), 168: (0, 0.28, 0.165),
        6: (0, 0.265, 0.17), 197: (0, 0.25, 0.18), 127: (-0.065, 0.29, 0.12),
        356: (0.065, 0.29, 0.12), 234: (-0.068, 0.25, 0.11), 454: (0.068, 0.25, 0.11),
    }.items():  # fmt: skip
        chosen[place] = nearest(at)
    mesh = vertices[:, chosen] * [1, -1, -1]
    angles = 0.2 * np.sin(np.arange(FRAMES) / 20)
    rotations = Rotation.from_rotvec(angles[:, None] * [0, 1, 0]).as_matrix()
    return np.asarray(900 * np.einsum("tab,tpb->tpa", rotations, mesh) + [320, 240, 0])


def detection(**changed: Any) -> Detection:
    arrays = {
        "pose": np.zeros((FRAMES, 33, 3)),
        "visibility": np.ones((FRAMES, 33)),
        "face": np.zeros((FRAMES, 478, 3)),
    }
    return Detection(frame_rate=30, **(arrays | changed))


def test_gestures_and_speech_are_recovered_from_a_camera_view(body: BodyModel) -> None:
    clip = talking()
    result = clip_from_detection(detection(pose=pose_of(clip), face=face_of(clip, body)), body)
    forearms = [(f"{side}_elbow", f"{side}_wrist") for side in ("left", "right")]
    assert largest_angle(clip, result, forearms) < 12
    assert result.frame_rate == 30
    for action in (JAW, BLINK):
        weights, expected = (arkit_of(each)[:, action] for each in (result, clip))
        assert np.corrcoef(weights, expected)[0, 1] > 0.9
        assert weights.max() > 0.3


def test_an_arm_out_of_the_picture_hangs_with_a_note(body: BodyModel) -> None:
    clip = talking()
    visibility = np.ones((FRAMES, 33))
    visibility[:, 13] = 0.1
    result = clip_from_detection(
        detection(pose=pose_of(clip), face=face_of(clip, body), visibility=visibility), body
    )
    assert "left arm is out of the picture" in result.provenance["notes"]
    at = joint_positions(result)
    hanging = at[:, joint_index("left_wrist"), 1] < at[:, joint_index("left_shoulder"), 1] - 0.3
    assert hanging.all()


def test_gaps_are_reported_and_short_ones_bridged() -> None:
    pose, face = np.zeros((400, 33, 3)), np.zeros((400, 478, 3))
    pose[:20] = face[:20] = np.nan
    face[100:105] = np.nan
    face[200:240] = np.nan
    result = Detection(frame_rate=30, pose=pose, visibility=np.ones((400, 33)), face=face)
    divided = [(part.start, part.end, part.reason) for part in stretches(result)]
    assert divided == [
        (0, 20, "nobody was found"),
        (20, 200, ""),
        (200, 240, "no face was found"),
        (240, 400, ""),
    ]
    face[101:104] = np.nan
    assert np.isfinite(result.stretch(20, 200).face).all()


def test_a_cut_ends_a_stretch_and_short_stretches_are_dropped() -> None:
    face = np.zeros((FRAMES, 478, 3))
    face[:, 454, 0] = 50
    face[100:, :, 0] += 200
    divided = [(part.start, part.end, part.reason) for part in stretches(detection(face=face))]
    assert divided == [(0, 100, ""), (100, FRAMES, "shorter than 2 s")]
