from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from tools.three_systems.line import Line

INIT = ("init", "made", "--template", "three-systems")


def test_a_command_is_run_once_and_again_where_what_it_depends_on_has_changed(
    tmp_path: Path,
) -> None:
    line = Line(tmp_path)
    line.run(*INIT, of="first")
    line.run(*INIT, of="first")
    (took,) = line.took().values()
    assert (tmp_path / "made" / "study.toml").exists()
    assert took.seconds > 0 and took.processor > 0
    with pytest.raises(InputError, match=r"'motionjury init made .*' failed"):
        line.run(*INIT, of="second")


def test_a_step_that_was_interrupted_is_done_again_and_its_time_is_kept(tmp_path: Path) -> None:
    line = Line(tmp_path)
    with pytest.raises(KeyboardInterrupt), line.step("import") as is_due:
        assert is_due
        raise KeyboardInterrupt
    before = line.took()["import"].seconds
    with line.step("import") as is_due:
        assert is_due
    assert line.took()["import"].seconds > before > 0
    with line.step("import") as is_due:
        assert not is_due
