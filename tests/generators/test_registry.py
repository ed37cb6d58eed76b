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
from generators.registry import TRAINABLE, find_trainable, load_generator
from generators.s2ue import config as s2ue
from motion.errors import InputError


@pytest.mark.parametrize(
    ("name", "weights", "message"),
    [
        ("telepathic", False, r"no generator 'telepathic'.*rule_based"),
        ("diffsheg", False, r"diffsheg is a network and was given no weights.*'checkpoint' in"),
        ("static", True, "static is no network"),
    ],
)
def test_a_generator_that_is_not_there_or_needs_other_settings_is_refused(
    name: str, weights: bool, message: str, tmp_path: Path
) -> None:
    (tmp_path / "weights.pt").write_bytes(b"")
    settings = ModelSettings(checkpoint=tmp_path / "weights.pt") if weights else None
    with pytest.raises(InputError, match=message):
        load_generator(name, settings)


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
