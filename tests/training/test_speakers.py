import pytest
import torch

from motion.errors import InputError
from training.speakers import Speakers, latent_loss

KNOWN = Speakers(("2", "4", "anna"), 5)


@pytest.mark.parametrize(("asked", "number"), [("anna", 3), ("2", 1), (2, 1), ("4", 2), ("3", 3)])
def test_a_speaker_is_found_by_name_or_number(asked: int | str, number: int) -> None:
    assert KNOWN.number(asked) == number
    assert KNOWN.one_hot([KNOWN.names[number - 1]]).argmax() == number - 1


@pytest.mark.parametrize("asked", ["zoe", 0, "5", -1])
def test_an_unknown_speaker_is_refused_with_the_known_ones(asked: int | str) -> None:
    with pytest.raises(InputError, match=f"no speaker '{asked}'.*1 to 3, or one of 2, 4 and anna"):
        KNOWN.number(asked)


def test_each_unknown_speaker_maps_to_a_fixed_known_one() -> None:
    names = [f"stranger {number}" for number in range(30)]
    result = [KNOWN.number_or_substitute(name) for name in names]
    assert result == [KNOWN.number_or_substitute(name) for name in names]
    assert set(result) == {1, 2, 3}


def test_a_normal_latent_costs_nothing() -> None:
    nothing = torch.zeros(2, 4)
    assert float(latent_loss([(nothing, nothing)])) == 0
    assert float(latent_loss([(nothing + 1, nothing)])) == pytest.approx(0.5)
