"""Each template's study, from speech to videos that can be served, and to a report."""

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import av
import pandas as pd
import pytest

from analysis.report.figures import style
from motion.clip import moving_channels
from motion.errors import InputError
from studyapp.preflight.check import check
from studyapp.session.served_study import ServedStudy
from studyapp.stimuli.generation import generate
from studyapp.stimuli.recordings import Take, import_take
from studyapp.stimuli.render_plan import RenderPlan
from studyapp.stimuli.rendering import render
from studyapp.stimuli.shown_motion import read_motion_shown
from studyapp.study.folder import StudyFolder
from studyapp.study.media import read_stimuli
from studyapp.study.study_file import new_study
from tests.studyapp.conftest import OwnStudy
from tests.support.command_line import run
from tests.support.studies.finished_study import PROTOCOLS
from tests.support.studies.redefining import edited

pytestmark = pytest.mark.slow

FROZEN = ("face", "lower_body", "root")


@pytest.mark.parametrize("template", PROTOCOLS)
def test_every_template_runs_unchanged(
    tmp_path: Path, take: Callable[..., Take], template: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if template in ("rating", "ranking"):
        # They have many figures; those of the others are also written as files.
        monkeypatch.setattr("analysis.report.page.FORMATS", {})
    monkeypatch.setitem(style.STYLE, "pdf.fonttype", 3)
    folder = StudyFolder(tmp_path / "study")
    new_study(folder.definition, template=template, name="study")
    with edited(folder.definition) as document:
        document["video"].update({"size": 64, "frame_rate": 10})
        document["freeze"] = FROZEN
        document["participants_per_comparison" if template == "pairwise" else "participants"] = 3
        groups = {
            group["name"]: set(group["conditions"])
            for group in document.get("blocks", document.get("sets", ()))
        }
        for block in document.get("blocks", ()):
            block.pop("shortest", block.pop("longest", 0))
    import_take(folder, take(speech=2.0, motion=2.0, segment=1.0))
    generate(folder)
    shown = read_motion_shown(folder, folder.study(), folder.segments())
    assert not any(moving_channels(clip) & {*FROZEN} for clip in shown.values())
    assert any("hands" in moving_channels(clip) for clip in shown.values())

    count = render(folder, processes=1)

    assert count.failures == ()
    sizes = defaultdict(set)
    for content, video in ServedStudy.read(folder.root).videos.items():
        sizes[content[0].segment].add(video.file.stat().st_size)
        segment, speech = content[0].segment, content[0].speech
        with av.open(str(video.file)) as container:
            assert bool(container.streams.audio) == (speech is not None)
        # Of a motion with other speech, the file says so.
        assert ("@" in video.file.name) == (speech not in (None, segment))
    assert [len(different) for different in sizes.values()] == [1, 1]
    findings = check(folder)
    assert not [finding for finding in findings if finding.severity == "error"]
    telling = [finding for finding in findings if finding.name == "channel-tells-apart"]
    assert not any(finding.what.startswith(FROZEN) for finding in telling)
    assert render(folder, processes=1).made == 0
    pictures = defaultdict(set)
    for clip in read_stimuli(folder.stimuli).clips:
        pictures[clip.condition, clip.segment].add(encoded_picture(folder.root / clip.file))
    assert {len(different) for different in pictures.values()} == {1}

    run("rehearse", folder.root, "--seed", 1)
    run("metrics", folder.root, "--processes", 1)
    run("report", folder.root)
    run("export", folder.root, "--rehearsal")
    rows = pd.read_csv(folder.root / "rehearsal_responses.csv", keep_default_na=False)
    main = rows[rows["kind"] == "main"]
    for part, conditions in groups.items():
        assert set(main.loc[main["part"] == part, "condition"]) == conditions
    page = (folder.report / "report.html").read_text("utf-8")
    assert all(name.replace("_", " ") in page for name in folder.study().conditions)
    assert "of them in an earlier run" in run("rehearse", folder.root, "--seed", 1)


def encoded_picture(video: Path) -> bytes:
    with av.open(str(video)) as container:
        return b"".join(bytes(packet) for packet in container.demux(video=0))


def test_a_missing_finished_video_is_reported_with_its_path(own_study: OwnStudy) -> None:
    folder = own_study("mismatch")
    (gone,) = list((folder.videos / "ours").glob("one@*.mp4"))
    gone.unlink()

    count = render(folder, processes=1)

    assert [str(gone.relative_to(folder.root)) in failure for failure in count.failures] == [True]
    (error,) = [finding for finding in check(folder) if finding.severity == "error"]

    assert "with the speech of" in error.what
    assert str(gone) in error.remedy


def test_a_study_of_finished_videos_has_no_motion_to_draw(own_study: OwnStudy) -> None:
    with pytest.raises(InputError, match="only finished videos and no motion to draw"):
        RenderPlan.of(own_study("rating"))
