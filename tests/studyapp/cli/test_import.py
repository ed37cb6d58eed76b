from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.command_line import run


@pytest.mark.parametrize(
    "flags",
    [
        ["--speech", "take.wav"],
        ["--segment", "10"],
        ["--emotion", "neutral"],
        ["--fps", "0"],
        ["--emotion", "boredom"],
    ],
)
def test_import_names_options_that_belong_together(tmp_path: Path, flags: list[str]) -> None:
    run("init", tmp_path / "s")
    (tmp_path / "take.wav").touch()
    (tmp_path / "take.bvh").touch()
    flags = [str(tmp_path / "take.wav") if flag == "take.wav" else flag for flag in flags]
    result = run(
        "import", tmp_path / "take.bvh", "--condition", "x", *flags, tmp_path / "s", status=2
    )
    assert "--" in result


def test_import_of_a_broken_file_names_it(tmp_path: Path) -> None:
    run("init", tmp_path / "s")
    motion, speech = tmp_path / "take.bvh", tmp_path / "take.wav"
    motion.write_text("this is not a BVH")
    speech.write_bytes(b"nor is this sound")
    result = run(
        "import", motion, "--speech", speech, "--condition", "ground_truth",
        "--speaker", "anna", "--emotion", "neutral", tmp_path / "s", status=1,
    )  # fmt: skip
    assert "take.wav" in result
    assert not (tmp_path / "s" / "speech").exists()


def test_import_reports_moved_hands_unless_they_are_left_as_recorded(
    tmp_path: Path, shared_data: Path
) -> None:
    motion, speech = (shared_data / f"2_scott_0_1_1.{ending}" for ending in ("bvh", "wav"))
    reported = []
    for name, flags in (("moved", []), ("left", ["--as-recorded"])):
        run("init", tmp_path / name)
        result = run(
            "import", motion, "--speech", speech, "--fps", 15, "--condition", "recording",
            "--speaker", "scott", "--emotion", "neutral", *flags, tmp_path / name,
        )  # fmt: skip
        reported.append("hands were moved out" in result)
        copied = tmp_path / "2_scott_0_1_1.bvh"
        copied.write_bytes(motion.read_bytes())
        more = ("--fps", 15, "--condition", "again", *flags)
        again = run("import", copied, *more, tmp_path / name)
        reported.append("hands were moved out" in again)
    assert reported == [True, True, False, False]
