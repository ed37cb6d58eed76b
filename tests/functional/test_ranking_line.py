"""The study of DiffSHEG's section 4.3, from recordings and a network to its report."""

from __future__ import annotations

import contextlib
import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from analysis.report.figures.style import STYLE
from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.formats import read_clip, write_clip
from motion.formats.beat_tracks import write_arkit_json
from tests.generators.diffsheg.small_network import written_network
from tests.support.command_line import run
from tests.support.studies.edited_study import edited

pytestmark = pytest.mark.slow

RATE = 16_000
PARTICIPANTS = 3
RANKED = {
    "long": {"diffsheg", "rule_based", "mismatched", "static", "flawed"},
    "short": {"diffsheg", "rule_based", "mismatched"},
}


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("researcher")


@pytest.fixture(scope="module")
def motionjury(home: Path) -> Callable[..., str]:
    """Return what runs a command where the researcher is."""

    def within(*arguments: object) -> str:
        with contextlib.chdir(home):
            return run(*arguments)

    return within


def record(home: Path, name: str, pitch: float) -> None:
    """Write four seconds of speech, body and face, as a recording's three files."""
    times = np.arange(4 * RATE) / RATE
    loudness = np.maximum(np.sin(2 * np.pi * 1.7 * times), 0)
    samples = (0.4 * loudness * np.sin(2 * np.pi * pitch * times)).astype(np.float32)
    write_wav(home / f"{name}.wav", Audio(samples=samples, sample_rate=RATE))
    poses = np.zeros((120, 55, 3), np.float32)
    poses[:, 16, 2] = -1.1 + 0.3 * np.sin(2 * np.pi * 1.7 * np.arange(120) / 30)
    poses[:, 17, 2] = 1.1
    take = MotionClip(poses=poses, trans=np.zeros((120, 3), np.float32), frame_rate=30)
    write_clip(home / f"{name}.npz", take)
    jaw = np.zeros((240, 51))
    jaw[:, 17] = np.maximum(np.sin(2 * np.pi * 1.7 * np.arange(240) / 60), 0)
    write_arkit_json(home / f"{name}.json", jaw, 60)


@pytest.fixture(scope="module")
def study(home: Path, motionjury: Callable[..., str]) -> Path:
    """Return a study that went through every command up to its report."""
    written_network(home / "net.safetensors")
    motionjury("init", "lab", "--template", "diffsheg", "--reference", "ground_truth")
    definition = home / "lab" / "study.toml"
    with edited(definition) as document:
        network = {"generator": "diffsheg", "checkpoint": str(home / "net.safetensors")}
        document["conditions"]["diffsheg"] = network
        document["participants"] = PARTICIPANTS
        document["video"].update({"size": 96, "frame_rate": 10})
        document["attention"]["trials"] = 0
        long, short = document["blocks"]
        long.update({"trials": 2, "shortest": 1.5})
        short.update({"trials": 2, "longest": 1.5})
        for block in (long, short):
            block["conditions"] = ["diffsheg", *list(block["conditions"])[:-1]]
        del document["conditions"]["mismatched_flawed"]
    for name, pitch, seconds in (("one", 140, 2), ("two", 180, 1)):
        record(home, name, pitch)
        motionjury(
            "import", f"{name}.npz", "--speech", f"{name}.wav", "--segment", seconds,
            "--condition", "ground_truth", "--speaker", "anna", "--emotion", "neutral", "lab",
        )  # fmt: skip
    output = motionjury("generate", "lab")
    assert "Uses stand-ins: diffsheg: stand-in for HuBERT" in output
    motionjury("render", "lab", "--processes", 1)
    assert "can be served" in motionjury("check", "lab")
    motionjury("rehearse", "lab", "--seed", 1)
    motionjury("metrics", "lab", "--processes", 1)
    with pytest.MonkeyPatch.context() as patch:
        # Fonts of this type are embedded several times as fast.
        patch.setitem(STYLE, "pdf.fonttype", 3)
        motionjury("report", "lab")
    return home / "lab"


def test_the_network_moved_face_and_body_and_the_recording_kept_its_own(study: Path) -> None:
    for segment in ("one_01", "two_04"):
        clip = read_clip(study / "motion" / "diffsheg" / f"{segment}.npz")
        assert clip.provenance["generator"] == "diffsheg"
        assert "from the last pose" in clip.provenance["sampling"]
        assert np.ptp(clip.poses, axis=0).max() > 0
        assert clip.arkit is not None
        assert np.ptp(clip.arkit, axis=0).max() > 0
        recorded = read_clip(study / "motion" / "ground_truth" / f"{segment}.npz")
        assert recorded.arkit is not None
        assert np.ptp(recorded.arkit[:, 17]) > 0.5


def test_everybody_ranks_all_systems_of_both_blocks_and_never_the_recording(
    study: Path, motionjury: Callable[..., str]
) -> None:
    motionjury("export", "lab", "--rehearsal")
    with (study / "rehearsal_responses.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len({row["study_session"] for row in rows}) == PARTICIPANTS
    assert {row["question"] for row in rows} == {
        "realism",
        "expression_synchrony",
        "gesture_synchrony",
        "diversity",
    }
    for part, systems in RANKED.items():
        assert {row["condition"] for row in rows if row["part"] == part} == systems


def test_the_report_draws_the_ranks_of_both_blocks(study: Path) -> None:
    page = (study / "report" / "report.html").read_text()
    assert "diffsheg" in page
    for part in RANKED:
        assert part in page
    assert list((study / "report" / "figures").glob("*.pdf"))
    for outside in ('src="http', 'href="http', "@import", "url(http"):
        assert outside not in page


def test_every_stage_done_again_makes_nothing_new(
    study: Path, motionjury: Callable[..., str]
) -> None:
    assert "Generated 0 clips" in motionjury("generate", study)
    assert "Rendered 0 videos" in motionjury("render", study)
    assert f"{PARTICIPANTS} of them in an earlier run" in motionjury("rehearse", study)
    assert "Wrote 0 answers" in motionjury("export", study)
    assert not (study / "responses.db").exists()
