from pathlib import Path

import av
import pytest
from PIL import Image

from motion.errors import InputError
from studyapp.stimuli.figures.material import FigureMaterial
from studyapp.study.folder import StudyFolder
from tests.support.command_line import refused, run

pytestmark = pytest.mark.slow

SEGMENT = "take_01"
BROKEN = ("still", "--segment", SEGMENT, "--condition", "broken")


def test_a_still_has_the_requested_size(study: StudyFolder, tmp_path: Path) -> None:
    path = tmp_path / "still.png"
    moment = ("--segment", SEGMENT, "--condition", "ground_truth", "--at", 0.9)
    command = ("figure", "still", study.root, *moment, "--size", 200, "--output", path)
    run(*command)
    with Image.open(path) as image:
        assert (image.size, image.mode) == ((200, 200), "RGB")
    run(*command, "--clear")
    with Image.open(path) as image:
        assert (image.size, image.mode) == ((200, 200), "RGBA")
        assert image.getpixel((0, 0))[3] == 0  # type: ignore[index]


def test_a_grid_shows_the_named_conditions_side_by_side(study: StudyFolder, tmp_path: Path) -> None:
    shown = ("--condition", "rule_based", "--condition", "ground_truth")
    path = tmp_path / "grid.mp4"
    options = ("--segment", SEGMENT, *shown, "--output", path)
    run("figure", "grid", study.root, *options)
    with av.open(str(path)) as video:
        stream = video.streams.video[0]
        assert sum(1 for _ in video.decode(stream)) == 10
        assert stream.average_rate == 10
        assert stream.width == 192


def test_a_strip_of_the_compared_conditions_is_reproducible(study: StudyFolder) -> None:
    command = ["figure", "strip", str(study.root), "--segment", SEGMENT, "--inches", "1.5",
               "--at", "0.9", "--at", "no=0.1"]  # fmt: skip
    paths = [study.figures / f"strip-{SEGMENT}{ending}" for ending in (".pdf", ".png")]
    drawn = []
    for _ in range(2):
        output = run(*command)
        assert all(str(path) in output for path in paths)
        drawn.append([path.read_bytes() for path in paths])
    assert drawn[0] == drawn[1]
    compared = [name for name in study.study().conditions if name != "broken"]
    assert list(FigureMaterial.read(study).labels([])) == compared


def test_conditions_can_have_other_labels_which_are_distinct(
    study: StudyFolder, tmp_path: Path
) -> None:
    material = FigureMaterial.read(study)
    labels = material.labels(["ground_truth=Recording", "rule_based"])
    assert labels == {"ground_truth": "Recording", "rule_based": "rule based"}
    assert material.labels(())["rule_based"] == "rule based"
    for repeated in (["rule_based=Ours", "mismatched=Ours"], ["rule_based", "rule_based=Ours"]):
        with pytest.raises(InputError, match="Use different labels"):
            material.labels(repeated)
    command = ("figure", "overlay", study.root, "--segment", SEGMENT, "--at", "0.5", "--inches", 1)
    run(*command, "--output", tmp_path / "overlay.png")
    assert (tmp_path / "overlay.png").is_file()


REFUSED = (
    (["still", "--segment", "no", "--condition", "static", "--at", "0"], "take_01, take_02"),
    (["still", "--segment", SEGMENT, "--condition", "no", "--at", "0"], "ground_truth, "),
    ([*BROKEN, "--at", "1.5"], "0 to 1.00 s"),
    (["strip", "--segment", SEGMENT, *["--at", "0.1"] * 17], "1 to 16"),
    (["strip", "--segment", SEGMENT, "--output", "strip.svg"], ".pdf or .png"),
    ([*BROKEN, "--at", "1", "--output", "a.jpg"], "as PNG"),
    (["grid", "--segment", SEGMENT, "--output", "grid.avi"], ".mp4"),
)


def test_unknown_names_and_formats_are_refused_with_the_known_ones(study: StudyFolder) -> None:
    for (command, *options), error in REFUSED:
        assert error in refused("figure", command, study.root, *options)
    assert not study.figures.exists()
