from pathlib import Path

import pytest
import torch
from safetensors.torch import save_file

from motion.errors import InputError
from training.weights_file import read_weights, write_weights

TENSORS = {"a.weight": torch.arange(6.0).reshape(2, 3).T, "b": torch.tensor([1], dtype=torch.uint8)}


def test_weights_survive_a_round_trip(tmp_path: Path) -> None:
    path = tmp_path / "new" / "w.safetensors"
    write_weights(path, TENSORS, {"name": "ä", "steps": [1, 2]})
    result = read_weights(path)
    assert result.facts == {"name": "ä", "steps": [1, 2]}
    assert torch.equal(result.tensors["a.weight"], TENSORS["a.weight"])
    assert list(result.with_prefix("a")) == ["weight"]


def test_an_unusable_file_is_named_with_a_remedy(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_weights(tmp_path / "none.safetensors")
    damaged = tmp_path / "damaged.safetensors"
    damaged.write_bytes(b"\x80\x04pickle?")
    with pytest.raises(InputError, match=r"damaged\.safetensors: .*motionjury train"):
        read_weights(damaged)
    foreign = tmp_path / "foreign.safetensors"
    for metadata in ({"format": "pt"}, {"motionjury": "{"}, {"motionjury": "[]"}):
        save_file({"b": TENSORS["b"]}, foreign, metadata=metadata)
        with pytest.raises(InputError, match="does not say what its weights are"):
            read_weights(foreign)


def test_a_failed_write_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, elsewhere = tmp_path / "w.safetensors", tmp_path / "gone" / "w"
    write_weights(path, TENSORS, {})
    before = path.read_bytes()
    monkeypatch.setattr(
        "training.weights_file.save_file",
        lambda tensors, draft, **rest: save_file(tensors, elsewhere, **rest),
    )
    with pytest.raises(InputError, match=r"w\.safetensors: .*cannot be stored.*Free space"):
        write_weights(path, TENSORS, {"new": 1})
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
