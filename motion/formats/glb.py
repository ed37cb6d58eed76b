"""A motion clip on a body as GLB, glTF 2.0 in one file, for Blender, Unity and web pages.

The mesh is skinned to SMPL-X's 55 joints and the body's twist joints, and each facial action that
the clip uses is a morph target. glTF has no sound: the speech is a separate file, which this one
names. Source: Khronos Group 2021, "glTF 2.0 Specification".
"""

import json
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.arrays import Floats32
from motion.body.model import BodyModel
from motion.body.skinning import four_strongest, turns_about_bones
from motion.body.surface import VertexNormals, surface_colours
from motion.clip import ARKIT_NAMES, MotionClip
from motion.files import replacing
from motion.skeleton import JOINT_NAMES, PARENTS

Node = dict[str, Any]

_COMPONENTS: Final = {"|u1": 5121, "<u2": 5123, "<u4": 5125, "<f4": 5126}
_TYPES: Final = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
_STILL: Final = 1e-6
"""Change below which a joint or a vertex does not move."""
_GAMMA: Final = 2.2


def write_glb(path: Path, clip: MotionClip, body: BodyModel, *, speech: str = "") -> None:
    """Write `clip` on `body` to `path`, in one step.

    A licensed body's pose correctives are omitted: glTF cannot express them.

    Parameters
    ----------
    path : Path
        The file; missing folders are made.
    clip : MotionClip
        The motion. Until it is played, joints are as in its first frame.
    body : BodyModel
        The body. Each vertex follows its four strongest joints.
    speech : str
        Name of the audio file in the same folder; empty for none.
    """
    binary = _Binary()
    turns = _joint_quaternions(clip, body)
    joints = _joint_nodes(clip, body, turns[0])
    weights = body.expression_weights(clip)
    slots = np.flatnonzero(np.any(weights, axis=0))
    mesh = _mesh(binary, clip, body, slots)
    document = {
        "asset": {
            "version": "2.0",
            "generator": "Motion Jury",
            **({"copyright": body.credits} if body.credits else {}),
            **({"extras": {"speech": speech}} if speech else {}),
        },
        "scene": 0,
        "scenes": [{"nodes": [0, len(joints)]}],
        "nodes": [*joints, {"name": "body", "mesh": 0, "skin": 0}],
        "meshes": [mesh],
        "materials": [
            {
                "name": "surface",
                "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.9},
            }
        ],
        "skins": [_skin(binary, clip, body)],
        "animations": [_animation(binary, clip, body, turns, weights[:, slots])],
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": len(binary.content)}],
    }
    json_chunk = json.dumps(document, separators=(",", ":")).encode()
    json_chunk += b" " * (-len(json_chunk) % 4)
    parts = ((b"JSON", json_chunk), (b"BIN\0", bytes(binary.content)))
    chunks = b"".join(len(part).to_bytes(4, "little") + kind + part for kind, part in parts)
    with replacing(path) as draft:
        draft.write_bytes(
            b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks
        )


class _Binary:
    """The file's binary data, and the document's description of it."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[Node] = []
        self.accessors: list[Node] = []

    def add(self, values: NDArray[Any], *, bounds: bool = False) -> int:
        """Add one element per row and return its accessor, with `bounds` if glTF demands them."""
        accessor = {"bufferView": self._view(values), **self._described(values)}
        return self._accessor(accessor, values if bounds else None)

    def add_sparse(self, values: Floats32) -> int:
        """Add vectors, shape (n, 3), most of which are zero."""
        rows = np.flatnonzero(np.abs(values).max(axis=1) > _STILL)
        arrays = {"indices": rows.astype("<u4"), "values": values[rows].astype("<f4")}
        stored = {name: {"bufferView": self._view(part)} for name, part in arrays.items()}
        stored["indices"]["componentType"] = _COMPONENTS["<u4"]
        accessor = self._described(values) | {"sparse": {"count": len(rows), **stored}}
        return self._accessor(accessor, values)

    def _view(self, values: NDArray[Any]) -> int:
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.content), "byteLength": values.nbytes}
        )
        self.content += values.tobytes()
        self.content += bytes(-len(self.content) % 4)
        return len(self.views) - 1

    def _described(self, values: NDArray[Any]) -> Node:
        return {
            "componentType": _COMPONENTS[values.dtype.str],
            "count": len(values),
            "type": _TYPES[values.shape[1:]],
        }

    def _accessor(self, accessor: Node, bounded: NDArray[Any] | None) -> int:
        if bounded is not None:
            low, high = bounded.min(axis=0), bounded.max(axis=0)
            accessor |= {"min": np.atleast_1d(low).tolist(), "max": np.atleast_1d(high).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _joint_quaternions(clip: MotionClip, body: BodyModel) -> Floats32:
    """Return quaternions of all joints, the body's twist joints last, shape (T, 55 + K, 4).

    A quaternion and its negative are the same rotation; each gets the sign that is nearer to its
    predecessor.
    """
    count = len(clip)
    turns = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float)).as_quat()
    turns = turns.reshape(count, -1, 4)
    if body.twist_joints is not None:
        about = turns_about_bones(turns, body.joints(clip.betas), body.twist_joints)
        twists = Rotation.from_rotvec(about.reshape(-1, 3)).as_quat()
        turns = np.concatenate([turns, twists.reshape(count, -1, 4)], axis=1)
    cosines = np.einsum("tja,tja->tj", turns[1:], turns[:-1])
    signs = np.cumprod(np.where(cosines < 0, -1.0, 1.0), axis=0)
    turns[1:] *= signs[..., None]
    return turns.astype("<f4")


def _joint_nodes(clip: MotionClip, body: BodyModel, turns: Floats32) -> list[Node]:
    """Return a node for each joint, rotated by its row of `turns`; the twist joints come last."""
    rest = body.joints(clip.betas)
    parents = _twist_carriers(body)
    parents[: len(PARENTS)] = PARENTS
    nodes: list[Node] = []
    for index, (carrier, parent) in enumerate(zip(_twist_carriers(body), parents, strict=True)):
        offset = rest[carrier] - rest[parent] if parent >= 0 else rest[0] + clip.trans[0]
        is_twist = index >= len(JOINT_NAMES)
        nodes.append(
            {
                "name": f"{JOINT_NAMES[carrier]}_twist{index}" if is_twist else JOINT_NAMES[index],
                "translation": offset.tolist(),
                "rotation": turns[index].tolist(),
            }
        )
        if parent >= 0:
            nodes[parent].setdefault("children", []).append(index)
    return nodes


def _mesh(binary: _Binary, clip: MotionClip, body: BodyModel, slots: NDArray[np.int_]) -> Node:
    """Return the mesh with a morph target for each of the `slots` expression directions."""
    vertices = body.shaped(clip.betas)
    joints, weights = four_strongest(body.weights)
    colours = surface_colours(body)[:, :3] ** _GAMMA
    attributes = {
        "POSITION": binary.add(vertices.astype("<f4"), bounds=True),
        "NORMAL": binary.add(VertexNormals(body).of(vertices).astype("<f4")),
        "COLOR_0": binary.add(colours.astype("<f4")),
        "JOINTS_0": binary.add(joints.astype("|u1")),
        "WEIGHTS_0": binary.add(weights.astype("<f4")),
    }
    primitive: Node = {
        "attributes": attributes,
        "indices": binary.add(body.faces.astype("<u4").reshape(-1)),
        "material": 0,
    }
    if not len(slots):
        return {"name": "body", "primitives": [primitive]}
    primitive["targets"] = [
        {"POSITION": binary.add_sparse(body.expression_directions[:, :, slot].astype("<f4"))}
        for slot in slots
    ]
    names = [ARKIT_NAMES[slot] if body.has_arkit_slots else f"expression{slot}" for slot in slots]
    return {
        "name": "body",
        "primitives": [primitive],
        "weights": [0.0] * len(slots),
        "extras": {"targetNames": names},
    }


def _skin(binary: _Binary, clip: MotionClip, body: BodyModel) -> Node:
    places = body.joints(clip.betas)[_twist_carriers(body)]
    inverses = np.tile(np.eye(4, dtype="<f4"), (len(places), 1, 1))
    inverses[:, 3, :3] = -places  # glTF stores columns, so the last row is the translation
    return {"inverseBindMatrices": binary.add(inverses), "joints": list(range(len(places)))}


def _twist_carriers(body: BodyModel) -> list[int]:
    """Return, for each joint of the skin, the skeleton's joint at its position."""
    twists = [] if body.twist_joints is None else body.twist_joints.bones[:, 0].tolist()
    return [*range(len(JOINT_NAMES)), *twists]


def _animation(
    binary: _Binary, clip: MotionClip, body: BodyModel, turns: Floats32, weights: Floats32
) -> Node:
    times = binary.add((np.arange(len(clip)) / clip.frame_rate).astype("<f4"), bounds=True)
    samplers: list[Node] = []
    channels: list[Node] = []

    def add(node: int, path: str, values: NDArray[Any]) -> None:
        channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
        samplers.append({"input": times, "output": binary.add(values)})

    add(0, "translation", (body.joints(clip.betas)[0] + clip.trans).astype("<f4"))
    for index in np.flatnonzero(np.ptp(turns, axis=0).max(axis=1) > _STILL).tolist():
        add(index, "rotation", turns[:, index])
    if weights.size:
        add(turns.shape[1], "weights", weights.astype("<f4").reshape(-1))
    return {"name": "motion", "samplers": samplers, "channels": channels}
