import hashlib
import json
import zlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmarks.rendering.sample_motion import gesturing_clip
from motion.body.model import BodyModel
from motion.clip import ARKIT_COUNT, MotionClip
from motion.errors import InputError
from motion.skeleton import JOINT_COUNT
from renderer.look import Look
from renderer.viewer.packing import LARGEST, track
from renderer.viewer.page import FILES, MotionFigures, Scene
from tests.motion.random_clips import clip_of


def test_the_bundled_library_matches_its_readme() -> None:
    library = (FILES / "three.min.js").read_bytes()

    assert hashlib.sha256(library).hexdigest() in (FILES / "README.md").read_text()
    assert b"three 0.187.0, MIT" in library[:80]


def test_shared_data_of_two_figures_is_embedded_once(clip: MotionClip) -> None:
    figures = MotionFigures(Look())
    for name in ("first", "second"):
        figures.figure(Scene(name=name, clips={name: clip}))

    assert figures.sources().count("<script") == 2


def test_names_are_escaped(clip: MotionClip) -> None:
    element = MotionFigures(Look()).figure(Scene(name="<b>", clips={"'><script>": clip}))

    assert "<b>" not in element
    assert "<script>" not in element


@pytest.mark.parametrize("count", [0, 7])
def test_too_few_or_too_many_clips_are_refused(count: int, clip: MotionClip) -> None:
    scene = Scene(name="many", clips={str(number): clip for number in range(count)})

    with pytest.raises(InputError, match="do not fit side by side"):
        MotionFigures(Look()).figure(scene)


def unpacked(data: bytes) -> tuple[dict[str, Any], dict[str, NDArray[np.int16]]]:
    """Return the facts and the arrays of packed data, as the docstring of `pack` describes."""
    content = zlib.decompress(data)
    start = 4 + int.from_bytes(content[:4], "little")
    facts = json.loads(content[4:start])
    arrays = {}
    for name, rows, columns in facts.pop("arrays"):
        count = rows * columns
        low, high = np.frombuffer(content, np.uint8, 2 * count, start).reshape(2, count)
        folded = low.astype(np.int64) + 256 * high.astype(np.int64)
        differences = np.where(folded % 2, -(folded + 1) // 2, folded // 2)
        values = np.cumsum(differences.reshape(columns, rows).T, axis=0)
        arrays[name] = values.astype(np.uint16).view(np.int16)
        start += 2 * count
    assert start == len(content)
    return facts, arrays


LARGEST_ANGLE = 0.05
"""Degrees."""


def largest_angle(clip: MotionClip, data: bytes) -> float:
    facts, values = unpacked(data)
    turns = values["turns"].reshape(-1, 3) * facts["steps"]["turns"]
    true = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float))
    return float(np.degrees((Rotation.from_rotvec(turns).inv() * true).magnitude().max()))


@settings(deadline=None)
@given(seed=st.integers(0, 2**32 - 1), spread=st.sampled_from([1e-4, 0.1, 1.0, 3.2, 30.0]))
def test_every_rotation_is_within_a_twentieth_of_a_degree(
    seed: int, spread: float, body: BodyModel
) -> None:
    poses = np.random.default_rng(seed).uniform(-spread, spread, (3, JOINT_COUNT, 3))
    clip = clip_of(poses)

    assert largest_angle(clip, track(clip, body)) < LARGEST_ANGLE


def test_ten_seconds_of_body_and_face_take_less_than_60_kilobytes(body: BodyModel) -> None:
    plain = gesturing_clip(10, 30)
    walk = np.random.default_rng(0).normal(0, 0.05, (len(plain), ARKIT_COUNT)).cumsum(axis=0)
    shaken = np.random.default_rng(1).normal(0, 0.002, plain.poses.shape)
    clip = clip_of(plain.poses + shaken, plain.trans, arkit=np.abs(np.sin(walk)))

    data = track(clip, body)

    assert len(data) < 60_000
    facts, values = unpacked(data)
    assert values["turns"].shape == (300, 165)
    assert values["weights"].shape == (300, ARKIT_COUNT)
    weights = values["weights"] * facts["steps"]["weights"]
    expected = body.expression_weights(clip)
    assert np.abs(weights - expected).max() < 0.0021
    shifts = values["shifts"] * facts["steps"]["shifts"]
    assert np.abs(shifts - clip.trans).max() < 1e-4
    assert largest_angle(clip, data) < LARGEST_ANGLE


@pytest.mark.parametrize("far", [1.0, 1e6])
def test_a_body_that_walks_away_keeps_its_path(far: float, body: BodyModel) -> None:
    trans = np.linspace(0, far, 6, dtype=np.float32).reshape(2, 3)
    clip = clip_of(np.zeros((2, JOINT_COUNT, 3)), trans)

    facts, values = unpacked(track(clip, body))

    shifts = values["shifts"] * facts["steps"]["shifts"]
    assert np.abs(shifts - trans).max() <= max(1e-4, far / LARGEST) / 2 + 1e-9 * far
