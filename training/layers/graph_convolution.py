"""Convolutions on graphs of landmarks, bones and anatomical components."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from training.spaces.anatomy import Parts

FloatArray = NDArray[np.float32]


class GraphConvolution(nn.Module):
    """Spatial-temporal convolution on a graph (ST-GCN), (B, C, T, N) to (B, D, T, N)."""

    shares: Tensor

    def __init__(self, width_in: int, width: int, edges: FloatArray, reach: int) -> None:
        super().__init__()
        shares = torch.from_numpy(edges / np.maximum(edges.sum(axis=0, keepdims=True), 1))
        self.register_buffer("shares", torch.stack([torch.eye(len(edges)), shares]))
        self.spatial = nn.Conv2d(width_in, 2 * width, 1)
        self.temporal = nn.Sequential(
            nn.BatchNorm2d(width),
            nn.LeakyReLU(0.1),
            nn.Conv2d(width, width, (reach, 1), padding=(reach // 2, 0)),
            nn.BatchNorm2d(width),
        )
        self.past = nn.Conv2d(width_in, width, 1)

    def forward(self, values: Tensor) -> Tensor:
        """Return what each node makes of itself, its neighbours and the frames around."""
        own, others = self.spatial(values).chunk(2, dim=1)
        gathered = own + others @ self.shares[1]
        found: Tensor = nn.functional.leaky_relu(self.temporal(gathered) + self.past(values), 0.1)
        return found


class ComponentEncoder(nn.Module):
    """Encoder of affective expressions (section 3.3.2), (B, T_in, N, 3) to (B, T_out, width).

    Parameters
    ----------
    edges : ndarray, shape (N, N)
        Of landmarks or bones.
    parts : tuple of tuple of int
        Nodes of each anatomical component.
    part_edges : ndarray or None
        Of the components; None leaves the higher graph out.
    frames : pair of int
        T_in, T_out.
    widths : triple of int
        Of a node, of a component and of the latent.
    reach : int
        Frames of temporal convolutions.
    """

    places: Tensor

    def __init__(
        self,
        edges: FloatArray,
        parts: Parts,
        part_edges: FloatArray | None,
        frames: tuple[int, int],
        widths: tuple[int, int, int],
        reach: int,
    ) -> None:
        super().__init__()
        node, part, width = widths
        longest = max(len(one) for one in parts)
        # The node behind the last one is zero: it fills smaller components.
        places = [[*one, *[len(edges)] * (longest - len(one))] for one in parts]
        self.register_buffer("places", torch.tensor(places).flatten(), persistent=False)
        self._shape = (len(parts), longest)
        self.nodes = GraphConvolution(3, node, edges, reach)
        self.parts = (
            None
            if part_edges is None
            else GraphConvolution(longest * node, part, part_edges, reach)
        )
        flat = len(edges) * node if part_edges is None else len(parts) * part
        self.spatial = nn.Sequential(
            nn.Conv1d(flat, width, 1), nn.BatchNorm1d(width), nn.LeakyReLU(0.1)
        )
        self.temporal = nn.Conv1d(frames[0], frames[1], 3, padding=1)

    def forward(self, values: Tensor) -> Tensor:
        """Return the latent of landmarks or bones."""
        found = self.nodes(values.permute(0, 3, 1, 2))
        if self.parts is not None:
            padded = nn.functional.pad(found, (0, 1)).index_select(-1, self.places)
            # (B, D, T, components, nodes)
            collated = padded.reshape(*padded.shape[:-1], *self._shape)
            found = self.parts(collated.permute(0, 1, 4, 2, 3).flatten(1, 2))
        flat = found.permute(0, 1, 3, 2).flatten(1, 2)
        latent: Tensor = self.temporal(self.spatial(flat).transpose(1, 2))
        return latent
