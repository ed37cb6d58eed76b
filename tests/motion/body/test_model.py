from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.body.archive import read_mean_hands
from motion.body.model import BodyModel, read_body
from motion.errors import InputError
from motion.skeleton import PARENTS
from tests.motion.random_clips import arkit_of, random_clip

Arrays = dict[str, Any]
VERTICES = 300
LICENSED = 9940  # more than the highest vertex that smplx's landmark table names


def _random_arrays(vertices: int) -> Arrays:
    """Return a body with everything a licensed one has, in random numbers."""
    rng = np.random.default_rng(0)
    weights = rng.random((vertices, 55)) ** 8
    regressor = np.zeros((55, vertices))
    regressor[np.arange(55)[:, None], rng.integers(0, vertices, (55, 20))] = 1 / 20
    shapes = np.zeros((vertices, 3, 400), np.float32)
    shapes[:, :, :10] = rng.normal(0, 0.01, (vertices, 3, 10))
    shapes[:, :, 300:310] = rng.normal(0, 0.01, (vertices, 3, 10))
    return {
        "v_template": rng.normal(0, 0.5, (vertices, 3)),
        "f": rng.integers(0, vertices, (100, 3)).astype(np.uint32),
        "shapedirs": shapes,
        "posedirs": rng.normal(0, 0.001, (vertices, 3, 486)).astype(np.float32),
        "J_regressor": regressor,
        "weights": weights / weights.sum(axis=1, keepdims=True),
        "kintree_table": np.stack([np.array(PARENTS), np.arange(55)]),
        "hands_componentsl": np.zeros((45, 45)),
        "hands_componentsr": np.zeros((45, 45)),
        "hands_meanl": np.zeros(45),
        "hands_meanr": np.zeros(45),
        "lmk_faces_idx": np.zeros(51, np.int64),
        "lmk_bary_coords": np.full((51, 3), 1 / 3),
    }


@pytest.fixture(scope="module")
def arrays() -> Arrays:
    return _random_arrays(VERTICES)


@pytest.fixture(scope="module")
def body(arrays: Arrays, tmp_path_factory: pytest.TempPathFactory) -> BodyModel:
    return _read(tmp_path_factory.mktemp("body"), arrays)


def _read(folder: Path, arrays: Arrays, **given: Any) -> BodyModel:
    np.savez(folder / "smplx_random.npz", **arrays)
    return read_body(folder / "smplx_random.npz", **given)


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::UserWarning")
def test_vertices_match_smplx(tmp_path: Path) -> None:
    smplx = pytest.importorskip("smplx")
    torch = pytest.importorskip("torch")
    body = _read(tmp_path, _random_arrays(LICENSED))
    clip, drawn = random_clip(4), np.random.default_rng(1).normal(size=(4, 10))
    expressions = np.pad(drawn, ((0, 0), (0, 90))).astype(np.float32)
    clip = replace(clip, betas=clip.betas[:10], expressions=expressions, arkit=None)
    model = smplx.create(
        str(tmp_path / "smplx_random.npz"), model_type="smplx", ext="npz", use_pca=False,
        flat_hand_mean=True,
        num_betas=10, num_expression_coeffs=10, batch_size=4,
    )  # fmt: skip
    poses = torch.tensor(clip.poses)
    output = model(
        betas=torch.tensor(clip.betas)[None].expand(4, -1),
        expression=torch.tensor(expressions[:, :10]),
        global_orient=poses[:, 0],
        body_pose=poses[:, 1:22].reshape(4, -1),
        jaw_pose=poses[:, 22],
        leye_pose=poses[:, 23],
        reye_pose=poses[:, 24],
        left_hand_pose=poses[:, 25:40].reshape(4, -1),
        right_hand_pose=poses[:, 40:].reshape(4, -1),
        transl=torch.tensor(clip.trans),
    )
    np.testing.assert_allclose(body.vertices(clip), output.vertices.detach().numpy(), atol=1e-4)
    rest = model(betas=torch.tensor(clip.betas)[None]).joints[0, :55].detach().numpy()
    np.testing.assert_allclose(body.joints(clip.betas), rest, atol=1e-4)


@pytest.mark.parametrize("part", [slice(0, 8), slice(3, 17), slice(18, 30)])
def test_posing_some_frames_equals_posing_all(body: BodyModel, part: slice) -> None:
    clip = random_clip(19)
    np.testing.assert_allclose(body.vertices(clip, part), body.vertices(clip)[part], atol=1e-5)


def test_a_face_in_other_parameters_needs_a_matrix(body: BodyModel) -> None:
    matrix = np.random.default_rng(5).normal(0, 1, (100, 52)).astype(np.float32)
    clip = random_clip(2)
    assert clip.expressions is not None
    for has_slots, foreign, expected in (
        (True, replace(clip, arkit=None), np.clip(clip.expressions @ matrix, 0, 1)),
        (False, replace(clip, expressions=None), arkit_of(clip) @ matrix.T),
    ):
        without = replace(body, has_arkit_slots=has_slots)
        assert without.face(foreign) is None
        converted = replace(without, expression_matrix=matrix).face(foreign)
        assert converted is not None
        np.testing.assert_allclose(converted, expected, atol=1e-5)


def test_files_with_ten_shape_and_ten_expression_components_are_read(
    arrays: Arrays, tmp_path: Path
) -> None:
    shapes = arrays["shapedirs"]
    short = np.concatenate([shapes[:, :, :10], shapes[:, :, 300:310]], axis=2)
    body = _read(tmp_path, arrays | {"shapedirs": short})
    np.testing.assert_array_equal(body.shape_directions, shapes[:, :, :10])
    np.testing.assert_array_equal(body.expression_directions, shapes[:, :, 300:310])


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (lambda a: {name: a[name] for name in a if name != "weights"}, "lacks weights"),
        (lambda a: a | {"weights": a["weights"][:, :52]}, "weights of the body model has shape"),
        (lambda a: a | {"kintree_table": a["kintree_table"][:, ::-1]}, "joint tree"),
        (lambda a: a | {"v_template": np.float32(1)}, r"v_template .* has shape \(\)"),
    ],
)
def test_a_file_that_is_not_an_smplx_body_is_refused(
    arrays: Arrays, tmp_path: Path, broken: Callable[[Arrays], Arrays], message: str
) -> None:
    with pytest.raises(InputError, match=message) as caught:
        _read(tmp_path, broken(arrays))
    assert caught.value.where == str(tmp_path / "smplx_random.npz")
    assert caught.value.remedy


def test_a_damaged_or_missing_body_is_refused_by_name(arrays: Arrays, tmp_path: Path) -> None:
    path = tmp_path / "body.npz"
    np.savez(path, **arrays | {"f": np.array([{"a": 1}], dtype=object)})
    pickled = path.read_bytes()
    np.savez_compressed(path, **arrays)
    content = path.read_bytes()
    for damaged in (b"hello", content[:1000] + bytes(2000) + content[3000:], pickled):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"body\.npz: the file cannot be read as a body model"):
            read_body(path)
    with pytest.raises(InputError, match=r"gone\.npz: there is no such body model"):
        read_body(tmp_path / "gone.npz")


def test_only_licensed_files_have_mean_hands_left_then_right(tmp_path: Path) -> None:
    left, right = np.arange(45.0), -np.arange(45.0)
    np.savez(tmp_path / "a.npz", hands_meanl=left, hands_meanr=right)
    hands = read_mean_hands(tmp_path / "a.npz")
    assert hands is not None
    np.testing.assert_array_equal(hands.reshape(2, 45), [left, right])
    np.savez(tmp_path / "flat.npz", hands_meanl=0 * left, hands_meanr=0 * right)
    np.savez(tmp_path / "without.npz", other=left)
    for name in ("flat.npz", "without.npz"):
        assert read_mean_hands(tmp_path / name) is None
