"""Convolutions on graphs gather from neighbours alone, and components from their own nodes."""

from __future__ import annotations

import numpy as np
import torch

from training.layers.graph_convolution import ComponentEncoder, GraphConvolution
from training.spaces.anatomy import component_graph


def test_a_node_sees_itself_and_its_neighbours_and_no_others() -> None:
    edges = np.zeros((4, 4), np.float32)
    edges[0, 1] = edges[1, 0] = edges[2, 3] = edges[3, 2] = 1
    torch.manual_seed(1)
    layer = GraphConvolution(3, 5, edges, 1).eval()
    values = torch.randn(1, 3, 6, 4)
    moved = values.clone()
    moved[..., 1] += 1
    changed = (layer(moved) - layer(values)).abs().amax(dim=(0, 1, 2)) > 1e-6
    assert changed.tolist() == [True, True, False, False]


def test_time_is_seen_as_far_as_the_convolution_reaches() -> None:
    torch.manual_seed(1)
    layer = GraphConvolution(2, 3, np.zeros((1, 1), np.float32), 5).eval()
    values = torch.randn(1, 2, 12, 1)
    moved = values.clone()
    moved[:, :, 6] += 1
    changed = (layer(moved) - layer(values)).abs().amax(dim=(0, 1, 3)) > 1e-6
    assert changed.nonzero().ravel().tolist() == [4, 5, 6, 7, 8]


def test_a_component_of_few_nodes_is_filled_with_nothing() -> None:
    edges = np.zeros((3, 3), np.float32)
    torch.manual_seed(1)
    encoder = ComponentEncoder(
        edges, ((0, 1), (2,)), component_graph(2, pose=False), (4, 6), (3, 3, 5), 3
    ).eval()
    values = torch.randn(2, 4, 3, 3)
    assert encoder(values).shape == (2, 6, 5)
    assert encoder.places.tolist() == [0, 1, 2, 3]
