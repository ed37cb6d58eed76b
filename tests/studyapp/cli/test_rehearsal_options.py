from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.cli.rehearse_command import with_others
from tests.studyapp.made_study import make_study


def test_what_is_written_takes_the_place_of_what_the_file_states() -> None:
    study = make_study(rehearsal={"careless": 0.5, "strength": {"static": {"rhythm": 1}}})
    made = with_others(
        study, ["careless=0.1", "side-biased=0.2"], ["static:emotion=-1", "mismatched=0.25"]
    ).rehearsal
    assert (made.careless, made.side_biased, made.hasty) == (0.1, 0.2, study.rehearsal.hasty)
    assert made.strength == {"static": {"rhythm": 1, "emotion": -1}, "mismatched": {"*": 0.25}}


def test_without_options_the_file_holds() -> None:
    study = make_study()
    assert with_others(study, [], []) is study


@pytest.mark.parametrize(
    ("shares", "strengths", "named"),
    [
        (["asleep=0.1"], [], "unknown kind 'asleep'.*hasty"),
        (["careless"], [], "'careless' cannot be read.*KIND=SHARE"),
        (["careless=many"], [], "cannot be read"),
        (["careless=2"], [], "careless: .*less than or equal to 1"),
        (["careless=nan"], [], "careless"),
        (["careless=0.9", "hasty=0.5"], [], "more than 1"),
        ([], ["elsewhere=1"], "unknown condition 'elsewhere'"),
        ([], ["static:taste=1"], "unknown question 'taste'"),
        ([], ["=1"], "cannot be read.*CONDITION=LOGITS"),
        ([], ["static=inf"], "finite"),
    ],
)
def test_what_cannot_be_read_or_simulated_is_named(
    shares: list[str], strengths: list[str], named: str
) -> None:
    with pytest.raises(InputError, match=named):
        with_others(make_study(), shares, strengths)
