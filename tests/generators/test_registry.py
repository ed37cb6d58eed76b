"""The registry lists all generators and imports each only when it is used."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import is_dataclass
from pathlib import Path

import pytest

from generators import registry
from generators.amuse.config import MOTION_PRESETS, SPEECH_PRESETS
from generators.diffsheg import config as diffsheg
from generators.learned_settings import ModelSettings
from generators.registry import TRAINABLE, find_trainable, load_generator, needs_model
from generators.s2ue import config as s2ue
from motion.errors import InputError


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(InputError, match="rule_based") as refusal:
        load_generator("telepathic")
    assert "telepathic" in refusal.value.what


def test_a_network_without_weights_is_refused_with_the_key_that_names_them() -> None:
    assert needs_model("diffsheg")
    with pytest.raises(InputError, match="diffsheg is a network and was given no weights") as error:
        load_generator("diffsheg")
    assert "'checkpoint' in study.toml" in str(error.value.remedy)


def test_weights_for_a_generator_without_a_network_are_refused(tmp_path: Path) -> None:
    weights = tmp_path / "weights.pt"
    weights.write_bytes(b"")
    with pytest.raises(InputError, match="static is no network"):
        load_generator("static", ModelSettings(checkpoint=weights))


HOME = Path(registry.__file__).parent


@pytest.mark.parametrize(
    ("file", "result"),
    [
        ("trainables.toml", TRAINABLE),
        ("amuse/motion.toml", MOTION_PRESETS),
        ("amuse/speech.toml", SPEECH_PRESETS),
        ("diffsheg/presets.toml", diffsheg.PRESETS),
        ("s2ue/presets.toml", s2ue.PRESETS),
    ],
)
def test_each_key_of_a_packaged_file_is_known(file: str, result: Mapping[str, object]) -> None:
    _check_known(tomllib.loads((HOME / file).read_text("utf-8")), result)


def _check_known(keys: object, defaults: object) -> None:
    if isinstance(keys, dict):
        known = vars(defaults) if is_dataclass(defaults) else defaults
        assert isinstance(known, Mapping)
        assert keys.keys() <= known.keys()
        for key, value in keys.items():
            _check_known(value, known[key])


@pytest.mark.parametrize(
    ("name", "presets", "ablations"),
    [
        ("amuse", MOTION_PRESETS, None),
        ("amuse-speech", SPEECH_PRESETS, None),
        ("diffsheg", diffsheg.PRESETS, diffsheg.ABLATIONS),
        ("s2ue", s2ue.PRESETS, s2ue.ABLATIONS),
    ],
)
def test_the_configs_and_ablations_that_can_be_chosen_are_those_there_are(
    name: str, presets: Mapping[str, object], ablations: Mapping[str, object] | None
) -> None:
    trainable = find_trainable(name)
    assert set(trainable.configs) == set(presets)
    (choice,) = (choice for choice in trainable.choices if choice.name == "ablation")
    assert ablations is None or choice.values == tuple(ablations)
