"""The registry knows all generators and imports none of them before it must."""

from __future__ import annotations

import subprocess
import sys

import pytest

from generators.registry import generator_names, load_generator
from motion.errors import InputError


def test_naming_the_generators_imports_none() -> None:
    program = (
        "import sys\n"
        "from generators.registry import generator_names\n"
        "generator_names()\n"
        "homes = ('rule_based', 'static', 'mismatched', 'broken')\n"
        "print([m for m in sys.modules if m.startswith(tuple('generators.' + h for h in homes))],\n"
        "      [m for m in ('torch', 'librosa', 'OpenGL') if m in sys.modules])"
    )
    said = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert said.stdout.split("\n")[0] == "[] []"


def test_the_four_generators_of_the_first_study_are_there() -> None:
    assert set(generator_names()) >= {"rule_based", "mismatched", "static", "broken"}


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(InputError, match="rule_based") as refusal:
        load_generator("telepathic")
    assert "telepathic" in refusal.value.what
