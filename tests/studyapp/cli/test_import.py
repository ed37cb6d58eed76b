from __future__ import annotations

from pathlib import Path

from tests.support.command_line import run


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
