"""The scripts in docs/data.md that convert what is never opened here."""

from __future__ import annotations

import json
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from motion.skeleton import joint_index
from tests.training.data.recordings import write_clicks
from training.data.folders import read_takes
from training.features import read_smplx

DOCS = Path(__file__).parents[3] / "docs" / "data.md"


def script(name: str) -> str:
    blocks: list[str] = re.findall(
        r"```python\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL
    )
    return next(block for block in blocks if block.startswith(f"# python {name}"))


def test_shows_pickles_become_takes(tmp_path: Path) -> None:
    frames, clip = 5, tmp_path / "show" / "oliver" / "talk.webm" / "00_01" / "00_01.pkl"
    write_clicks(clip.with_suffix(".wav"), frames / 30)
    rng = np.random.default_rng(1)
    arrays = {
        "jaw_pose": rng.normal(size=(frames, 3)),
        "leye_pose": np.zeros((frames, 3)),
        "reye_pose": np.zeros((frames, 3)),
        "global_orient": np.zeros((frames, 1, 3)),
        "body_pose_axis": rng.normal(size=(frames, 21, 3)),
        "left_hand_pose": rng.normal(size=(frames, 12)),
        "right_hand_pose": rng.normal(size=(frames, 12)),
        "expression": rng.normal(size=(frames, 100)),
        "betas": np.zeros(300),
    }
    clip.write_bytes(pickle.dumps({**arrays, "batch_size": frames}))
    hands = {side: rng.normal(size=(45, 45)).tolist() for side in ("left", "right")}
    (tmp_path / "hands.json").write_text(json.dumps(hands))
    command = [sys.executable, "-c", script("show_to_npz.py")]
    subprocess.run([*command, tmp_path / "show", tmp_path / "hands.json"], check=True)
    found = read_takes(tmp_path / "show")
    assert not found.skipped
    motion = read_smplx(found.takes[0])
    np.testing.assert_allclose(
        motion.poses[:, joint_index("right_index1")],
        (arrays["right_hand_pose"] @ np.array(hands["right"])[:12])[:, :3],
        rtol=1e-5,
    )
    assert motion.expressions is not None
    np.testing.assert_allclose(motion.expressions, arrays["expression"], rtol=1e-6)
