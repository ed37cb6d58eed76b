"""Convolutions over time, and on graphs of landmarks, bones and anatomical components.

Bhattacharya et al. 2024, section 3.3.2.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
import torch
from torch import Tensor, nn

from motion.arrays import Floats32
from motion.formats.ted_npz import BONES

Parts = tuple[tuple[int, ...], ...]

BODY_PARTS: Final[Parts] = ((0, 1, 2), (3, 4, 5), (6, 7, 8))
"""Bones of torso, left and right arm (section 3.3.2)."""

_COMPONENT_OF: Final = {
    "brow": 0, "eye": 0, "cheek": 1, "nose": 1, "mouth": 2, "jaw": 3, "tongue": 3,
}  # fmt: skip
"""Eyes, nose, lips and lower jaw, by the beginning of the name of a landmark's facial action. The
paper does not name brows and cheeks; they belong to their neighbours."""

_CORNERS: Final = ("mouthSmile", "mouthFrown", "mouthDimple", "mouthStretch")
"""Actions of the corners of the lips, which are expressive and not for the phoneme predictor."""


def components_of(actions: Sequence[str]) -> Parts:
    """Return the landmarks of each anatomical component of the face, by their facial actions."""
    parts: tuple[list[int], ...] = ([], [], [], [])
    for landmark, action in enumerate(actions):
        start = next(start for start in _COMPONENT_OF if action.startswith(start))
        parts[_COMPONENT_OF[start]].append(landmark)
    return tuple(tuple(part) for part in parts)


def lips_of(actions: Sequence[str]) -> tuple[int, ...]:
    """Return the landmarks of the lips without their corners."""
    return tuple(
        landmark
        for landmark, action in enumerate(actions)
        if action.startswith("mouth") and not action.startswith(_CORNERS)
    )


def face_graph(components: Parts, neutral: Floats32) -> Floats32:
    """Return the adjacency of landmarks, (L, L) of 0 and 1.

    The landmarks of a component are all adjacent. Two components are linked by their nearest pair
    of landmarks.
    """
    count = len(neutral)
    edges = np.zeros((count, count), np.float32)
    distances = np.linalg.norm(neutral[:, None] - neutral, axis=-1)
    for component in components:
        edges[np.ix_(component, component)] = 1
        for other_component in components:
            if other_component is not component and component and other_component:
                gaps = distances[np.ix_(component, other_component)]
                nearest, other_nearest = np.unravel_index(gaps.argmin(), gaps.shape)
                edges[component[nearest], other_component[other_nearest]] = edges[
                    other_component[other_nearest], component[nearest]
                ] = 1
    np.fill_diagonal(edges, 0)
    return edges


def bone_graph(hops: int) -> Floats32:
    """Return the adjacency of bones, (9, 9): those within `hops` shared joints of each other."""
    adjacent = np.array(
        [[bool(set(bone) & set(other)) for other in BONES] for bone in BONES], np.float32
    )
    reachable = np.linalg.matrix_power(adjacent, hops) > 0
    edges = reachable.astype(np.float32)
    np.fill_diagonal(edges, 0)
    return edges


def component_graph(count: int, *, pose: bool) -> Floats32:
    """Return the adjacency of components: all pairs of the face; the torso with each arm."""
    edges = np.ones((count, count), np.float32)
    if pose:
        edges[1:, 1:] = 0
    np.fill_diagonal(edges, 0)
    return edges


BODY_EDGES: Final = component_graph(len(BODY_PARTS), pose=True)


class GraphConvolution(nn.Module):
    """Spatial-temporal convolution on a graph (ST-GCN), (B, C, T, N) to (B, D, T, N)."""

    shares: Tensor

    def __init__(self, width_in: int, width: int, edges: Floats32, kernel: int) -> None:
        super().__init__()
        shares = torch.from_numpy(edges / np.maximum(edges.sum(axis=0, keepdims=True), 1))
        self.register_buffer("shares", torch.stack([torch.eye(len(edges)), shares]))
        self.spatial = nn.Conv2d(width_in, 2 * width, 1)
        self.temporal = nn.Sequential(
            nn.BatchNorm2d(width),
            nn.LeakyReLU(0.1),
            nn.Conv2d(width, width, (kernel, 1), padding=(kernel // 2, 0)),
            nn.BatchNorm2d(width),
        )
        self.past = nn.Conv2d(width_in, width, 1)

    def forward(self, values: Tensor) -> Tensor:
        """Return features of each node, its neighbours and the frames around it."""
        nodes, neighbours = self.spatial(values).chunk(2, dim=1)
        gathered = nodes + neighbours @ self.shares[1]
        output: Tensor = nn.functional.leaky_relu(self.temporal(gathered) + self.past(values), 0.1)
        return output


class ComponentEncoder(nn.Module):
    """Encoder of affective expressions (section 3.3.2), (B, T_in, N, 3) to (B, T_out, width).

    Parameters
    ----------
    edges : ndarray, shape (N, N)
        Edges between landmarks or bones.
    parts : tuple of tuple of int
        Nodes of each anatomical component.
    part_edges : ndarray or None
        Edges between the components; None omits the graph of components.
    frames : pair of int
        Numbers of frames T_in and T_out.
    widths : triple of int
        Widths of a node, of a component and of the latent.
    kernel : int
        Kernel size of temporal convolutions, in frames.
    """

    places: Tensor

    def __init__(
        self,
        edges: Floats32,
        parts: Parts,
        part_edges: Floats32 | None,
        frames: tuple[int, int],
        widths: tuple[int, int, int],
        kernel: int,
    ) -> None:
        super().__init__()
        node, part, width = widths
        longest = max(len(nodes) for nodes in parts)
        # The node after the last one is zero and pads smaller components.
        positions = [[*nodes, *[len(edges)] * (longest - len(nodes))] for nodes in parts]
        self.register_buffer("places", torch.tensor(positions).flatten(), persistent=False)
        self._shape = (len(parts), longest)
        self.nodes = GraphConvolution(3, node, edges, kernel)
        self.parts = (
            None
            if part_edges is None
            else GraphConvolution(longest * node, part, part_edges, kernel)
        )
        flat = len(edges) * node if part_edges is None else len(parts) * part
        self.spatial = nn.Sequential(
            nn.Conv1d(flat, width, 1), nn.BatchNorm1d(width), nn.LeakyReLU(0.1)
        )
        self.temporal = nn.Conv1d(frames[0], frames[1], 3, padding=1)

    def forward(self, values: Tensor) -> Tensor:
        """Return the latent of landmarks or bones."""
        nodes = self.nodes(values.permute(0, 3, 1, 2))
        if self.parts is not None:
            padded = nn.functional.pad(nodes, (0, 1)).index_select(-1, self.places)
            # (B, D, T, components, nodes)
            collated = padded.reshape(*padded.shape[:-1], *self._shape)
            nodes = self.parts(collated.permute(0, 1, 4, 2, 3).flatten(1, 2))
        flat = nodes.permute(0, 1, 3, 2).flatten(1, 2)
        latent: Tensor = self.temporal(self.spatial(flat).transpose(1, 2))
        return latent


def over_time(width_in: int, width: int, kernel: int, dilation: int = 1) -> nn.Sequential:
    """Return a convolution over time with batch normalisation, (B, C, T) to (B, width, T)."""
    padding = kernel // 2 * dilation
    return nn.Sequential(
        nn.Conv1d(width_in, width, kernel, padding=padding, dilation=dilation),
        nn.BatchNorm1d(width),
        nn.LeakyReLU(0.1),
    )


class Decoder(nn.Module):
    """Decodes motion: convolutions over time and over features, then a dense layer."""

    def __init__(self, width: int, hidden: int, values: int) -> None:
        super().__init__()
        self.temporal = nn.Sequential(over_time(width, hidden, 5), over_time(hidden, hidden, 5))
        self.spatial = nn.Sequential(
            nn.Conv1d(1, 4, 5, padding=2), nn.LeakyReLU(0.1), nn.Conv1d(4, 1, 5, padding=2)
        )
        self.full = nn.Sequential(
            nn.Linear(hidden, 2 * hidden), nn.LeakyReLU(0.1), nn.Linear(2 * hidden, values)
        )

    def forward(self, embedding: Tensor) -> Tensor:
        """Return motion (B, T, values) of an embedding (B, T, H)."""
        over_time = self.temporal(embedding.transpose(1, 2)).transpose(1, 2)
        batch, frames, width = over_time.shape
        over_features = self.spatial(over_time.reshape(batch * frames, 1, width))
        values: Tensor = self.full(over_time + over_features.reshape(batch, frames, width))
        return values
