"""Networks have the paper's parts, and each ablation lacks what it says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
import torch
from torch import Tensor

from generators.s2ue.model import Network, Synthesis
from motion.errors import InputError
from tests.generators.s2ue.small_network import FACE, SMALL, small_network
from training.layers.convolutions import ComponentEncoder, components_of

VALUES = 27 + 3 * FACE.count
COMPONENTS = components_of(FACE.actions)


def told(network: Network, **changed: Tensor) -> Tensor:
    chance = torch.Generator().manual_seed(1)
    given = {
        "sound": torch.randn(2, 34, 84, generator=chance),
        "words": torch.randn(2, 34, 300, generator=chance),
        "person": torch.eye(2)[[0, 0]],
        "noise": torch.zeros(2, len(network.config.modalities), SMALL.speaker_width),
        "seeds": network.mean + 0.1 * torch.randn(2, 4, VALUES, generator=chance),
    } | changed
    values, _ = network.synthesise(**given)
    return values


def test_motion_has_all_frames_and_depends_on_all_that_is_given() -> None:
    network = small_network()
    plain = told(network)
    assert plain.shape == (2, 34, VALUES)
    for name, shape in (("sound", (34, 84)), ("words", (34, 300)), ("seeds", (4, VALUES))):
        assert not torch.allclose(told(network, **{name: torch.rand(2, *shape)}), plain), name
    assert not torch.allclose(told(network, person=torch.eye(2)[[1, 1]]), plain)
    noise = torch.ones(2, 1, SMALL.speaker_width)
    assert not torch.allclose(told(network, noise=noise), plain)


def test_one_embedding_tells_face_and_pose_unless_they_are_apart() -> None:
    for synchronous in (True, False):
        network = small_network(synchronous=synchronous)
        seeds = network.mean.expand(2, 4, VALUES).clone()
        before = told(network, seeds=seeds)
        seeds[..., 27:] += 1e-3
        pose = (told(network, seeds=seeds) - before)[..., :27]
        assert bool(pose.abs().max() > 1e-6) == synchronous
    assert len(network.generator) == len(network.discriminator) == 2


@pytest.mark.parametrize("modality", ["face", "pose"])
def test_the_higher_graph_can_be_left_out(modality: str) -> None:
    network = small_network(**{f"{modality}_graph": False})
    synthesis = network.generator[0]
    assert isinstance(synthesis, Synthesis)
    encoders = dict(synthesis.seeds.items())
    assert isinstance(encoders[modality], ComponentEncoder)
    assert {name: one.parts is None for name, one in encoders.items()} == {
        name: name == modality for name in encoders
    }
    assert told(network).shape == (2, 34, VALUES)


def test_lips_are_the_phoneme_predictors_and_their_corners_are_not() -> None:
    network = small_network()
    values = told(network)
    heard = torch.randn(2, 34, 128)
    assert network.lips_heard(heard).shape == (2, 34, len(network.lips), 3)
    whole = network.with_lips(values, heard)
    changed = (whole - values).abs().amax(dim=(0, 1))[27:].reshape(-1, 3).amax(dim=1) > 0
    assert changed.nonzero().ravel().tolist() == network.lips


def test_every_weight_learns_from_some_loss() -> None:
    network = small_network().train().requires_grad_(True)
    found = told(network)
    loss = found.square().sum() + network.judged(found).sum()
    loss = loss + network.lips_heard(torch.randn(2, 34, 128)).square().sum()
    torch.autograd.backward(loss)
    idle = [name for name, one in network.named_parameters() if one.grad is None]
    assert idle == []


@pytest.mark.parametrize(
    "changes", [{"hidden": 0}, {"seeds": 34}, {"faces": False, "poses": False}]
)
def test_a_network_of_nothing_is_refused(changes: Mapping[str, Any]) -> None:
    with pytest.raises(InputError, match="tells nothing"):
        small_network(**changes)
