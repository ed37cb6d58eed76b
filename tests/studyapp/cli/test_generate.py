from pathlib import Path

from motion.formats import read_clip
from tests.generators.diffsheg.small_network import written_network
from tests.support.command_line import run
from tests.support.studies.takes import write_speech


def test_recordings_get_motion_without_a_study_and_stand_ins_are_reported(tmp_path: Path) -> None:
    speech = ("--speech", write_speech(tmp_path / "hello.wav", 1))
    checkpoint = written_network(tmp_path / "small.safetensors")
    network = ("generate", "--generator", "diffsheg", "--checkpoint", checkpoint, *speech)
    given = (*network, "--out", tmp_path / "out", "--fps", 25, "--seed")
    output = run(*given, 4)
    assert "Generated 1 clip," in output
    assert "Uses stand-ins: diffsheg: stand-in for HuBERT" in output
    clip = read_clip(tmp_path / "out" / "hello.npz")
    assert (len(clip), clip.frame_rate) == (25, 25)
    assert clip.provenance["seed"] == "4"
    again = run(*given, 4)
    assert "Generated 0 clips, kept 1" in again
    assert "Uses stand-ins" in again
    assert "Generated 1 clip," in run(*given, 5)

    output = run("generate", "--generator", "static", *speech, "--out", tmp_path)
    assert "Uses stand-ins" not in output
    assert len(read_clip(tmp_path / "hello.npz")) == 30
