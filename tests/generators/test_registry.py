"""The registry knows all generators and imports none of them before it must."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from generators.learned_settings import ModelSettings
from generators.registry import load_generator, needs_model
from motion.errors import InputError


def test_naming_the_generators_imports_none() -> None:
    program = (
        "import sys\n"
        "from generators.registry import generator_names\n"
        "generator_names()\n"
        "homes = ('rule_based', 'static', 'mismatched', 'broken', 'diffsheg.generate')\n"
        "print([m for m in sys.modules if m.startswith(tuple('generators.' + h for h in homes))],\n"
        "      [m for m in ('torch', 'transformers', 'librosa', 'OpenGL') if m in sys.modules])"
    )
    said = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert said.stdout.split("\n")[0] == "[] []"


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(InputError, match="rule_based") as refusal:
        load_generator("telepathic")
    assert "telepathic" in refusal.value.what


def test_a_network_without_weights_says_which_key_names_them() -> None:
    assert needs_model("diffsheg")
    with pytest.raises(InputError, match="diffsheg is a network and was given no weights") as said:
        load_generator("diffsheg")
    assert "'checkpoint' in study.toml" in str(said.value.remedy)


def test_weights_for_a_generator_without_a_network_are_refused(tmp_path: Path) -> None:
    weights = tmp_path / "weights.pt"
    weights.write_bytes(b"")
    with pytest.raises(InputError, match="static is no network"):
        load_generator("static", ModelSettings(checkpoint=weights))
