"""The study of DiffSHEG's section 4.3, from recordings and a network to its report."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.report.figures.style import STYLE
from motion.formats import read_clip
from motion.formats.beat_tracks import write_arkit_json
from tests.generators.diffsheg.small_network import written_network
from tests.support.command_line import run
from tests.support.studies.redefining import edited
from tests.support.studies.takes import write_motion, write_speech

pytestmark = pytest.mark.slow

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
    """Return a function that runs a command in the researcher's folder."""

    def within(*arguments: object) -> str:
        with contextlib.chdir(home):
            return run(*arguments)

    return within


def record(home: Path, name: str, seconds: int) -> None:
    """Write speech, body and face, as a recording's three files."""
    write_speech(home / f"{name}.wav", seconds)
    write_motion(home / f"{name}.npz", seconds)
    jaw = np.zeros((60 * seconds, 51))
    jaw[:, 17] = np.maximum(np.sin(2 * np.pi * 1.7 * np.arange(len(jaw)) / 60), 0)
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
        del document["conditions"]["mismatched_flawed"], document["questions"][2:]
    for name, seconds in (("one", 2), ("two", 1)):
        record(home, name, 2 * seconds)
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


def test_everybody_ranks_the_systems_of_both_blocks_and_the_report_shows_them(
    study: Path, motionjury: Callable[..., str]
) -> None:
    moved = read_clip(study / "motion" / "diffsheg" / "one_01.npz")
    recorded = read_clip(study / "motion" / "ground_truth" / "one_01.npz")
    assert moved.provenance["generator"] == "diffsheg"
    assert moved.arkit is not None and recorded.arkit is not None
    for values in (moved.poses, moved.arkit, recorded.arkit):
        assert np.ptp(values, axis=0).max() > 0.01
    motionjury("export", "lab", "--rehearsal")
    rows = pd.read_csv(study / "rehearsal_responses.csv")
    assert rows["study_session"].nunique() == PARTICIPANTS
    assert rows["question"].nunique() == 2
    page = (study / "report" / "report.html").read_text()
    for part, systems in RANKED.items():
        assert set(rows.loc[rows["part"] == part, "condition"]) == systems
        assert part in page
    assert "diffsheg" in page
    assert list((study / "report" / "figures").glob("*.pdf"))
    for outside in ('src="http', 'href="http', "@import", "url(http"):
        assert outside not in page


def test_repeating_every_stage_changes_nothing(study: Path, motionjury: Callable[..., str]) -> None:
    assert "Generated 0 clips" in motionjury("generate", study)
    assert "Rendered 0 videos" in motionjury("render", study)
    assert f"{PARTICIPANTS} of them in an earlier run" in motionjury("rehearse", study)
    assert not (study / "responses.db").exists()
