import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.body.abilities import read_expression_matrix, unsupported
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import joint_index
from tests.motion.random_clips import clip_of

ARKIT, COEFFICIENTS = np.full((2, 52), 0.5), np.ones((2, 100))

FACES: list[dict[str, Any]] = [{"arkit": ARKIT}, {"expressions": COEFFICIENTS}, {"jaw": 0.2}]
MATRIX = np.random.default_rng(0).normal(0, 0.3, (100, 52)).astype(np.float32)


BODIES: dict[str, dict[str, Any]] = {
    "arkit": {},
    "components": {"has_arkit_slots": False},
    "with a matrix": {"expression_matrix": MATRIX},
    "faceless": {"expression_directions": np.zeros((0, 3, 0))},
    "shaped": {"shape_directions": np.zeros((0, 3, 10))},
}


def _clip(**more: Any) -> MotionClip:
    poses = np.zeros((2, 55, 3))
    poses[:, joint_index("jaw"), 0] = more.pop("jaw", 0)
    return clip_of(poses, **more)


@pytest.mark.parametrize(
    ("kind", "clip", "sentence"),
    [
        ("arkit", {"expressions": COEFFICIENTS}, "given as SMPL-X .*video.expression_matrix"),
        ("components", {"arkit": ARKIT}, "given as ARKit .*expression_matrix"),
        ("with a matrix", {"expressions": COEFFICIENTS}, None),
        *(("faceless", face, "this body has none") for face in FACES),
        ("arkit", {"arkit": 0 * ARKIT, "expressions": COEFFICIENTS}, None),
        ("arkit", {"betas": np.ones(10)}, "does not take on"),
        ("shaped", {"betas": np.ones(300)}, "only the first 10 of the clip's 300 betas"),
        ("shaped", {"betas": np.pad(np.ones(10), (0, 290))}, None),
    ],
)
def test_unsupported_features_are_noted(
    body: BodyModel, kind: str, clip: dict[str, Any], sentence: str | None
) -> None:
    message = unsupported(_clip(**clip), replace(body, **BODIES[kind]))
    assert len(message) == (sentence is not None)
    assert sentence is None or re.search(sentence, message[0])


def test_a_matrix_is_read(tmp_path: Path) -> None:
    np.save(tmp_path / "m.npy", MATRIX.astype(np.float64))
    np.testing.assert_array_equal(read_expression_matrix(tmp_path / "m.npy"), MATRIX)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (np.zeros((100, 51)), r"shape is \(100, 51\)"),
        (np.full((100, 52), np.nan), "NaN"),
        (np.full((100, 52), "x"), "type <U1"),
        (MATRIX.T, r"shape is \(52, 100\)"),
        (b"", "not an expression matrix"),
        (None, "No such file"),
    ],
)
def test_files_that_are_not_matrices_are_refused(
    tmp_path: Path, content: np.ndarray | bytes | None, message: str
) -> None:
    path = tmp_path / "m.npy"
    if isinstance(content, np.ndarray):
        np.save(path, content)
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_expression_matrix(path)
    assert caught.value.where == str(path)
    assert caught.value.remedy


def test_the_bodys_own_face_parameters_take_precedence(body: BodyModel) -> None:
    both = _clip(expressions=COEFFICIENTS, arkit=ARKIT)
    for has_arkit_slots, expected in ((True, both.arkit), (False, both.expressions)):
        shown = replace(body, has_arkit_slots=has_arkit_slots, expression_matrix=MATRIX)
        assert shown.face(both) is expected
