from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from motion.errors import InputError
from tools.handbook.fenced import fenced_blocks
from tools.handbook.guide import GUIDE
from tools.handbook.running import run_page, steady


def page_of(script: str, *, info: str = "", printed: str = "text", between: str = "\n") -> str:
    return f"Before\n\n```sh{info}\n{script}\n```\n{between}```{printed}\nold\n```\n\nAfter\n"


def test_commands_run_in_one_folder_and_their_output_is_inserted(
    tmp_path: Path,
) -> None:
    script = "# One\n" + page_of("echo none") + "# Two\n"
    script += page_of("echo one > note; echo two >&2") + page_of("cat note; false", info=" fails")
    elsewhere = page_of("touch ran", info=" elsewhere")
    apart = page_of("echo new", between="\nAnd this is a file:\n\n")

    page = run_page(
        script + elsewhere + apart + "# Three\n" + page_of("echo 3"),
        tmp_path,
        since="# Two",
        until="# Three",
    )

    printed = [block.body for block in fenced_blocks(page) if block.language == "text"]
    assert printed == ["old\n", "two\n", "one\n", "old\n", "old\n", "old\n"]
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(
    ("script", "info", "problem"),
    [
        ("echo no such thing; false; echo never", "", "no such thing"),
        ("true", " fails", "expected to fail"),
    ],
)
def test_unexpected_failure_or_success_of_a_command_stops(
    tmp_path: Path, script: str, info: str, problem: str
) -> None:
    with pytest.raises(InputError, match=problem):
        run_page(page_of(script, info=info), tmp_path)


def test_changing_one_setting_keeps_the_others(tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(
        '# kept\nseed = 1\n[video]\nsize = 720\navatar = "alex"\n[gone.a]\nb = 1\n[gone.c]\nd = 2\n'
    )

    run_page('```toml study.toml -gone.a\nname = "mine"\n[video]\nsize = 480\n```\n', tmp_path)

    assert file.read_text().startswith("# kept\n")
    assert tomllib.loads(file.read_text()) == {
        "seed": 1,
        "name": "mine",
        "video": {"size": 480, "avatar": "alex"},
        "gone": {"c": {"d": 2}},
    }


def test_output_that_varies_between_runs_is_hidden(tmp_path: Path) -> None:
    output = (
        "render: 3 of 80 frames, 65 a second, about 05:24 left\n"
        "Open http://127.0.0.1:8000/research/join/aB-9_x (once)\n"
        f"Wrote {tmp_path}/report.html  \n"
    )

    assert steady(output, tmp_path) == [
        "Open http://127.0.0.1:8000/research/join/… (once)",
        "Wrote report.html",
    ]


@pytest.mark.slow
def test_the_guides_first_steps_work_as_printed(tmp_path: Path) -> None:
    page = GUIDE.read_text(encoding="utf-8")

    assert run_page(page, tmp_path, until="**Recorded motion.**") == page, "run 'make guide'"
