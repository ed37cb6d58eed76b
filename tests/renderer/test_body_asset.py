from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from motion.body import BodyModel
from motion.face import arkit_index
from motion.rest_pose import REST_JOINTS
from motion.skeleton import joint_index
from renderer import body_asset

ROOT = Path(__file__).resolve().parents[2]


def test_rest_joints_are_those_of_the_default_body(body: BodyModel) -> None:
    np.testing.assert_allclose(body.joints(np.zeros(0)), REST_JOINTS, atol=6e-5)


def test_body_stands_upright_facing_forward_with_its_left_at_positive_x(body: BodyModel) -> None:
    joints = body.joints(np.zeros(0))
    height = np.ptp(body.template[:, 1])
    assert 1.6 < height < 1.9
    assert joints[joint_index("left_wrist"), 0] > 0.5 > -0.5 > joints[joint_index("right_wrist"), 0]
    assert joints[joint_index("left_eye"), 2] > joints[joint_index("head"), 2]


def test_skin_weights_sum_to_one(body: BodyModel) -> None:
    np.testing.assert_allclose(body.weights.sum(axis=1), 1, atol=1e-5)


def test_each_facial_action_moves_its_own_side_of_the_face(body: BodyModel) -> None:
    blink = np.linalg.norm(body.expression_directions[..., arkit_index("eyeBlinkLeft")], axis=1)
    assert 0.004 < blink.max() < 0.03
    assert np.average(body.template[:, 0], weights=blink) > 0.02


def test_jaw_joint_opens_the_mouth_and_keeps_the_forehead(body: BodyModel) -> None:
    weights = body.weights[:, [joint_index("jaw")]].toarray().ravel()
    eyes = REST_JOINTS[joint_index("left_eye"), 1]
    assert weights[body.template[:, 1] > eyes].max() == pytest.approx(0, abs=0.05)
    assert (weights > 0.9).sum() > 100


def test_body_says_whose_work_it_is(body: BodyModel) -> None:
    assert "Apache-2.0" in body.credits
    assert "CC0" in body.credits


def test_cache_folder_can_be_chosen(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("MOTIONJURY_CACHE", str(tmp_path / "here"))
    assert body_asset.cache_folder() == tmp_path / "here"


_ASK = """
import time
from renderer import body_asset
def build(path):
    time.sleep(0.3)
    with path.open("ab") as file:
        file.write(b"x")
body_asset._build = build
print(body_asset.default_body())
"""


def test_processes_that_start_together_build_the_body_once(tmp_path: Path) -> None:
    environment = {**os.environ, "MOTIONJURY_CACHE": str(tmp_path)}
    asking = [
        subprocess.Popen([sys.executable, "-c", _ASK], env=environment, cwd=ROOT) for _ in range(3)
    ]
    assert [process.wait() for process in asking] == [0, 0, 0]
    [built] = tmp_path.glob("*.npz")
    assert built.read_bytes() == b"x"


def test_file_name_changes_with_the_code_that_builds_it(body_path: Path) -> None:
    assert body_asset.BODY_VERSION in body_path.name
