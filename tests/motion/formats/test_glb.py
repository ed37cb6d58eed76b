import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from benchmarks.rendering.sample_motion import gesturing_clip
from motion.arrays import Floats32
from motion.body.model import BodyModel
from motion.clip import MotionClip, arkit_index
from motion.formats.glb import write_glb
from motion.skeleton import JOINT_NAMES, forward_kinematics
from tests.motion.random_clips import arkit_of, clip_of

SMILE, BLINK = arkit_index("mouthSmileLeft"), arkit_index("eyeBlinkRight")


@pytest.fixture(scope="module")
def clip() -> MotionClip:
    """Return a clip that gestures, walks a little, smiles and blinks."""
    moving = gesturing_clip(1.0, 20)
    arkit = np.zeros((20, 52), np.float32)
    arkit[:, SMILE] = np.linspace(0, 1, 20)
    arkit[7, BLINK] = 1
    trans = moving.trans + np.linspace(0, 0.5, 20)[:, None] * [1, 0, 1]
    return clip_of(moving.poses, trans, 20, arkit=arkit)


def document_of(path: Path) -> tuple[dict[str, Any], bytes]:
    content = path.read_bytes()
    length = int.from_bytes(content[12:16], "little")
    return json.loads(content[20 : 20 + length]), content[28 + length :]


def values_of(path: Path, accessor: int) -> Floats32:
    document, binary = document_of(path)
    accessor_facts = document["accessors"][accessor]
    view = document["bufferViews"][accessor_facts["bufferView"]]
    result = np.frombuffer(
        binary, np.float32, view["byteLength"] // 4, offset=view.get("byteOffset", 0)
    )
    return result.reshape(accessor_facts["count"], -1)


def test_stills_and_animation_place_each_joint_by_another_reader(
    clip: MotionClip, body: BodyModel, tmp_path: Path
) -> None:
    expected, _ = forward_kinematics(clip.poses, clip.trans, body.joints(clip.betas))
    write_glb(tmp_path / "whole.glb", clip, body)
    document, _ = document_of(tmp_path / "whole.glb")
    animation = document["animations"][0]
    for frame in (0, 7, 19):
        write_glb(tmp_path / "frame.glb", clip.frames(slice(frame, frame + 1)), body)
        scene = trimesh.load_scene(tmp_path / "frame.glb")
        result = [scene.graph.get(name)[0][:3, 3] for name in JOINT_NAMES]
        np.testing.assert_allclose(result, expected[frame], atol=1e-4)
        still, _ = document_of(tmp_path / "frame.glb")
        nodes = [dict(node) for node in document["nodes"][:-1]]
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            times = values_of(tmp_path / "whole.glb", sampler["input"])
            np.testing.assert_allclose(times[:, 0], np.arange(20) / 20, atol=1e-6)
            if channel["target"]["path"] != "weights":
                track = values_of(tmp_path / "whole.glb", sampler["output"])
                nodes[channel["target"]["node"]][channel["target"]["path"]] = track[frame]
        for node, other in zip(nodes, still["nodes"], strict=False):
            np.testing.assert_allclose(node["translation"], other["translation"], atol=1e-6)
            alike = abs(np.dot(node["rotation"], other["rotation"]))
            assert alike == pytest.approx(1, abs=1e-6)


def test_used_facial_actions_are_morph_targets_and_speech_and_authors_are_credited(
    clip: MotionClip, body: BodyModel, tmp_path: Path
) -> None:
    write_glb(tmp_path / "a.glb", clip, body, speech="a.wav")

    document, _ = document_of(tmp_path / "a.glb")
    assert document["asset"]["extras"] == {"speech": "a.wav"}
    assert "Anny" in document["asset"]["copyright"]
    mesh = document["meshes"][0]
    assert mesh["extras"]["targetNames"] == ["eyeBlinkRight", "mouthSmileLeft"]
    channel = document["animations"][0]["channels"][-1]
    assert channel["target"]["path"] == "weights"
    sampler = document["animations"][0]["samplers"][channel["sampler"]]
    weights = values_of(tmp_path / "a.glb", sampler["output"]).reshape(20, 2)
    np.testing.assert_allclose(weights, arkit_of(clip)[:, [BLINK, SMILE]], atol=1e-6)


def test_the_mesh_is_the_coloured_body(clip: MotionClip, body: BodyModel, tmp_path: Path) -> None:
    write_glb(tmp_path / "a.glb", clip, body)

    mesh = trimesh.load_scene(tmp_path / "a.glb").geometry["body"]
    np.testing.assert_allclose(mesh.vertices, body.template, atol=1e-6)
    assert np.array_equal(mesh.faces, body.faces)
    document, _ = document_of(tmp_path / "a.glb")
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    colours = values_of(tmp_path / "a.glb", attributes["COLOR_0"])
    assert len(np.unique(colours, axis=0)) > 10
