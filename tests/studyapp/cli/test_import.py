from __future__ import annotations

from pathlib import Path

from motion.errors import InputError
from studyapp.study.folder import lock_folder
from tests.support.command_line import refused, run
from tests.support.studies.takes import write_motion, write_speech


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


def test_a_second_import_at_the_same_time_is_refused_and_no_segment_is_lost(tmp_path: Path) -> None:
    study = tmp_path / "study"
    run("init", study)
    motion = write_motion(tmp_path / "a.npz", 1.0)
    speech = write_speech(tmp_path / "a.wav", 1)
    command = (
        "import", motion, "--speech", speech, "--condition", "ours", "--speaker", "a",
        "--emotion", "fear", study,
    )  # fmt: skip
    with lock_folder(study, busy=InputError("busy")):
        assert "Wait until that command ends" in refused(*command)
        assert [path.name for path in study.iterdir()] == ["study.toml"]
    run(*command)
