"""What the packaged files say of sizes, trainings and ablations."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import is_dataclass
from pathlib import Path

import pytest

from generators import registry
from generators.amuse.config import MOTION_PRESETS, SPEECH_PRESETS
from generators.diffsheg import config as diffsheg
from generators.registry import TRAINABLE, trainable_of
from generators.s2ue import config as s2ue

HOME = Path(registry.__file__).parent


@pytest.mark.parametrize(
    ("file", "found"),
    [
        ("trainables.toml", TRAINABLE),
        ("amuse/motion.toml", MOTION_PRESETS),
        ("amuse/speech.toml", SPEECH_PRESETS),
        ("diffsheg/presets.toml", diffsheg.PRESETS),
        ("s2ue/presets.toml", s2ue.PRESETS),
    ],
)
def test_each_key_of_a_packaged_file_is_known(file: str, found: Mapping[str, object]) -> None:
    _check_known(tomllib.loads((HOME / file).read_text("utf-8")), found)


def _check_known(told: object, found: object) -> None:
    if isinstance(told, dict):
        known = vars(found) if is_dataclass(found) else found
        assert isinstance(known, Mapping)
        assert told.keys() <= known.keys()
        for key, value in told.items():
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
    trainable = trainable_of(name)
    assert set(trainable.configs) == set(presets)
    (choice,) = (choice for choice in trainable.choices if choice.name == "ablation")
    assert ablations is None or choice.values == tuple(ablations)
