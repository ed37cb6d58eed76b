from __future__ import annotations

import pytest
import torch

from motion.errors import InputError
from training.speakers import SpeakerEncoder, Speakers, latent_loss

KNOWN = Speakers(("2", "4", "anna"), 5)


@pytest.mark.parametrize(("asked", "number"), [("anna", 3), ("2", 1), (2, 1), ("4", 2), ("3", 3)])
def test_a_speaker_is_found_by_name_and_else_by_number(asked: int | str, number: int) -> None:
    assert KNOWN.number(asked) == number
    assert KNOWN.one_hot([KNOWN.names[number - 1]]).argmax() == number - 1


@pytest.mark.parametrize("asked", ["zoe", 0, "5", -1])
def test_an_unknown_speaker_is_refused_with_the_known_ones(asked: int | str) -> None:
    with pytest.raises(InputError, match=f"no speaker '{asked}'.*1 to 3, or one of 2, 4 and anna"):
        KNOWN.number(asked)


def test_an_unknown_speaker_is_always_the_same_known_one_and_not_all_are_one() -> None:
    names = [f"stranger {number}" for number in range(30)]
    result = [KNOWN.number_or_substitute(name) for name in names]
    assert result == [KNOWN.number_or_substitute(name) for name in names]
    assert set(result) == {1, 2, 3}


def test_a_normal_latent_costs_nothing() -> None:
    nothing = torch.zeros(2, 4)
    assert float(latent_loss([(nothing, nothing)])) == 0
    assert float(latent_loss([(nothing + 1, nothing)])) == pytest.approx(0.5)


def test_speakers_have_latents_of_their_own_and_mixtures_lie_between_them() -> None:
    torch.manual_seed(1)
    encode = SpeakerEncoder(3, 4)
    means, variances = encode(torch.eye(3))
    assert means.shape == variances.shape == (3, 4)
    assert (means[0] - means[1]).abs().max() > 1e-3
    between, _ = encode(torch.tensor([[0.5, 0.5, 0.0]]))
    torch.testing.assert_close(between[0], means[:2].mean(dim=0))
