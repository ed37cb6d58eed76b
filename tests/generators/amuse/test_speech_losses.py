"""What AMUSE's speech model learns by."""

from __future__ import annotations

import pytest
import torch

from generators.amuse.losses import (
    MASKED_BANDS,
    MASKED_ROWS,
    OTHER_CONTENT,
    OTHER_STYLE,
    SpeechLosses,
    augmented,
    speech_losses,
)
from generators.amuse.speech import SpeechModel
from tests.generators.amuse.test_speech import SMALL


def _losses(counted: SpeechLosses, heard: torch.Tensor) -> dict[str, float]:
    torch.manual_seed(1)
    model = SpeechModel(SMALL).eval()
    classes = torch.tensor([[[0, 0, 0, 0]], [[0, 0, 1, 1]]])
    losses = speech_losses(model, heard, heard, classes, counted)
    return {name: float(value.detach()) for name, value in losses.items()}


def _four() -> torch.Tensor:
    return torch.randn(1, 4, 64, 32, generator=torch.Generator().manual_seed(3))


def test_the_index_maps_are_those_printed_in_the_paper() -> None:
    assert tuple((6 - k) % 4 for k in range(1, 5)) == OTHER_CONTENT
    assert tuple((1 + k) % 4 for k in range(1, 5)) == OTHER_STYLE


def test_the_loss_is_the_sum_of_seven() -> None:
    losses = _losses(SpeechLosses(), _four())
    parts = {name: value for name, value in losses.items() if name != "loss"}
    assert set(parts) == {"self", "con", "xcon", "emo", "xemo", "sty", "xsty"}
    assert losses["loss"] == pytest.approx(sum(parts.values()), rel=1e-5)


@pytest.mark.parametrize(
    ("counted", "left_out"),
    [
        (SpeechLosses(style=False), {"sty", "xsty"}),
        (SpeechLosses(emotion=False), {"emo", "xemo"}),
    ],
)
def test_an_ablation_drops_two_losses(counted: SpeechLosses, left_out: set[str]) -> None:
    full, fewer = (_losses(one, _four()) for one in (SpeechLosses(), counted))
    assert set(full) - set(fewer) == left_out


def test_swapping_parts_of_equal_speech_costs_nothing() -> None:
    losses = _losses(SpeechLosses(), _four()[:, :1].expand(-1, 4, -1, -1))
    assert losses["con"] == pytest.approx(0, abs=1e-6)
    for name in ("xcon", "xemo", "xsty"):
        assert losses[name] == pytest.approx(losses["self"], rel=1e-5)


def test_contents_gain_nothing_by_all_coming_nearer() -> None:
    torch.manual_seed(1)
    model = SpeechModel(SMALL).eval()
    classes = torch.tensor([[[0, 0, 0, 0]], [[0, 0, 1, 1]]])
    found = []
    for _ in range(2):
        losses = speech_losses(model, _four(), _four(), classes, SpeechLosses())
        found.append(float(losses["con"].detach()))
        linear = model.content.feature_head[1]
        with torch.no_grad():
            linear.weight *= 10
    assert found[0] == pytest.approx(found[1], rel=0.1)


def test_masks_stay_within_their_shares_and_hide_the_same_from_both() -> None:
    torch.manual_seed(2)
    filterbanks = torch.ones(40, 1024, 128)
    heard, target = augmented(filterbanks)
    hidden = target == 0
    rows, bands = hidden.all(dim=2).sum(dim=1), hidden.all(dim=1).sum(dim=1)
    assert int(rows.max()) <= round(MASKED_ROWS * 1024)
    assert int(bands.max()) <= round(MASKED_BANDS * 128)
    assert int(rows.max()) > 0
    assert int(bands.max()) > 0
    # What is heard is noisy by a tenth at most, and shifted.
    assert float((heard.sum() - target.sum()) / heard.numel()) < 0.1
    assert float(heard.max()) <= 1.1
