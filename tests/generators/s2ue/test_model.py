"""Networks have the paper's parts, and each ablation lacks its own."""

import math

import pytest
import torch
from torch import Tensor

from generators.s2ue.config import LossWeights
from generators.s2ue.losses import (
    discriminator_loss,
    diversity_loss,
    generator_loss,
    phoneme_loss,
    reconstruction_losses,
)
from generators.s2ue.model import Network
from tests.generators.s2ue.small_network import FACE, SMALL, small_network
from training.layers.convolutions import components_of
from training.spaces.bones_and_landmarks import joint_tensors

VALUES = 27 + 3 * FACE.count
COMPONENTS = components_of(FACE.actions)


def outputs(network: Network, **changed: Tensor) -> Tensor:
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


def test_motion_has_all_frames_and_depends_on_every_input() -> None:
    network = small_network()
    plain = outputs(network)
    assert plain.shape == (2, 34, VALUES)
    for name, shape in (("sound", (34, 84)), ("words", (34, 300)), ("seeds", (4, VALUES))):
        assert not torch.allclose(outputs(network, **{name: torch.rand(2, *shape)}), plain), name
    assert not torch.allclose(outputs(network, person=torch.eye(2)[[1, 1]]), plain)
    noise = torch.ones(2, 1, SMALL.speaker_width)
    assert not torch.allclose(outputs(network, noise=noise), plain)


def test_face_and_pose_share_one_embedding_unless_they_are_separate() -> None:
    for synchronous in (True, False):
        network = small_network(synchronous=synchronous)
        seeds = network.mean.expand(2, 4, VALUES).clone()
        before = outputs(network, seeds=seeds)
        seeds[..., 27:] += 1e-3
        pose = (outputs(network, seeds=seeds) - before)[..., :27]
        assert bool(pose.abs().max() > 1e-6) == synchronous
    assert len(network.generator) == len(network.discriminator) == 2


@pytest.mark.parametrize("modality", ["face", "pose"])
def test_the_higher_graph_can_be_left_out(modality: str) -> None:
    network = small_network(**{f"{modality}_graph": False})
    encoders = network.get_submodule("generator.0.seeds").named_children()
    assert [name for name, encoder in encoders if encoder.parts is None] == [modality]
    assert outputs(network).shape == (2, 34, VALUES)


def test_lips_are_the_phoneme_predictors_and_their_corners_are_not() -> None:
    network = small_network()
    values = outputs(network)
    heard = torch.randn(2, 34, 128)
    assert network.predict_lips(heard).shape == (2, 34, len(network.lips), 3)
    whole = network.with_lips(values, heard)
    changed = (whole - values).abs().amax(dim=(0, 1))[27:].reshape(-1, 3).amax(dim=1) > 0
    assert changed.nonzero().ravel().tolist() == network.lips


WEIGHTS = LossWeights(velocity=2.0, acceleration=3.0)


def motion(seed: int) -> torch.Tensor:
    return torch.randn(2, 5, VALUES, generator=torch.Generator().manual_seed(seed))


def test_equation_16_compares_positions_and_velocities() -> None:
    true = torch.zeros(1, 3, 2, 3)
    result = true.clone()
    result[:, 1] = 0.5
    # A third of the frames is off by 0.5; both steps are.
    assert float(phoneme_loss(result, true, torch.tensor(0.1))) == pytest.approx(
        (0.5 / 3 + 0.5) / 0.1
    )


def test_equation_17_compares_positions_motions_and_velocities() -> None:
    network = small_network()
    network.spread.copy_(torch.tensor([1e-3, 0.5, 0.1]))
    one, two = motion(1), motion(2)
    result = reconstruction_losses(network, one, two, WEIGHTS)
    pose, face = one[..., :27] - two[..., :27], one[..., 27:] - two[..., 27:]
    joints = joint_tensors(one[..., :27].reshape(2, 5, 9, 3)) - joint_tensors(
        two[..., :27].reshape(2, 5, 9, 3)
    )
    places = face.abs().mean() / 1e-3 + joints.abs().mean() / 0.1
    motions = face.abs().mean() / 1e-3 + pose.abs().mean() / 0.5
    steps = face.diff(dim=1).abs().mean() / 1e-3 + pose.diff(dim=1).abs().mean() / 0.5
    assert float(result["reconstruction"]) == pytest.approx(
        float(places + 2 * motions + 3 * steps), rel=1e-5
    )
    plain = reconstruction_losses(network, one, two, LossWeights(velocity=0, acceleration=0))
    assert float(plain["reconstruction"]) == pytest.approx(float(places), rel=1e-5)
    assert float(reconstruction_losses(network, one, one, WEIGHTS)["reconstruction"]) == 0


def test_the_loss_pushes_other_speakers_motion_away() -> None:
    network = small_network()
    true = network.mean.expand(1, 5, VALUES)
    near, far = true + 0.1 * network.deviation, true + 0.3 * network.deviation
    assert float(diversity_loss(network, near, far, true, 0.1)) == 0
    assert float(diversity_loss(network, far, near, true, 0.1)) == pytest.approx(0.3, abs=1e-5)
    assert float(diversity_loss(network, near, near, true, 0.1)) == pytest.approx(0.1, abs=1e-5)


def test_equations_18_and_19_are_logarithms_of_probabilities() -> None:
    recorded, synthesised = torch.tensor([[1.0]]), torch.tensor([[-2.0]])
    real, fake = (1 / (1 + math.exp(-float(one))) for one in (recorded, synthesised))
    assert float(generator_loss(synthesised)) == pytest.approx(-math.log(fake))
    assert float(discriminator_loss(recorded, synthesised)) == pytest.approx(
        -math.log(real) - math.log(1 - fake)
    )
