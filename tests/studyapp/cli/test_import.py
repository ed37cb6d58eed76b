from pathlib import Path

from motion.errors import InputError
from studyapp.study.folder import lock_folder
from tests.support.command_line import refused, run
from tests.support.studies.takes import write_motion, write_speech


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
