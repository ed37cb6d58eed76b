"""Whole small rehearsals through the real server."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from sqlalchemy import select

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder
from studyapp.models import StudySession
from studyapp.rehearsal.conduct import Conduct
from studyapp.rehearsal.eyes import rater_name
from studyapp.rehearsal.judgement import judge
from studyapp.rehearsal.population import default_population
from studyapp.rehearsal.raters import Rater
from studyapp.rehearsal.record import read_truth
from studyapp.rehearsal.run import rehearse
from studyapp.rehearsal.sight import SeenTrial
from studyapp.services.database import Database, sqlite_url
from studyapp.services.export import responses_table
from tests.studyapp.made_study import pair_plan

ANSWER = ["rater", "position", "question", "left_condition", "right_condition", "value"]


def answers(folder: StudyFolder) -> pd.DataFrame:
    """Every stored answer, and which rater gave it."""
    with closing(Database.open(sqlite_url(folder.rehearsal))) as database:
        table = responses_table(database)
        with database.reading() as session:
            raters = {
                str(sitting.id): rater_name(session, sitting)
                for sitting in session.scalars(select(StudySession))
            }
    return table.assign(rater=table["study_session"].map(raters))


def what_was_answered(folder: StudyFolder) -> list[tuple[object, ...]]:
    table = answers(folder)[ANSWER].sort_values(ANSWER[:3])
    return list(table.itertuples(index=False, name=None))


def servers(folder: StudyFolder) -> list[int]:
    """Ids of the processes whose command names the folder, this test's own aside."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            command = (process / "cmdline").read_bytes()
        except OSError:
            continue
        if b"studyapp.rehearsal.server" in command and str(folder.root).encode() in command:
            found.append(int(process.name))
    return found


def wait_for(what: str, *, happens: Callable[[], object], seconds: float = 120) -> None:
    deadline = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < deadline, f"{what} did not happen"
        time.sleep(0.05)


@pytest.fixture(scope="module")
def answered(rendered: Path, tmp_path_factory: pytest.TempPathFactory) -> list[tuple[object, ...]]:
    """What a rehearsal with seed 3 answers when nothing interrupts it."""
    folder = StudyFolder(Path(shutil.copytree(rendered, tmp_path_factory.mktemp("whole") / "tiny")))
    rehearse(folder, seed=3)
    return what_was_answered(folder)


def test_everybody_gets_a_code_and_every_answer_is_stored(folder: StudyFolder) -> None:
    seen: list[tuple[int, int]] = []
    result = rehearse(
        folder,
        seed=3,
        population=replace(default_population(folder.study()), kinds={}),
        on_done=lambda done, total: seen.append((done, total)),
    )
    assert (result.completed, result.kept, result.left) == (6, 0, 0)
    assert seen == [(done, 6) for done in range(7)]
    assert result.truth == read_truth(folder.rehearsal_truth)
    assert "somebody else's trial" in {probe.name for probe in result.probes}
    table = answers(folder)
    # 1 practice, 3 main, 1 repeat, 1 catch; two questions each.
    assert table.groupby("study_session").size().tolist() == [12] * 6
    assert table.groupby("comparison")["study_session"].nunique().tolist() == [3, 3]
    assert (table["watched"] == 1).all()
    assert not servers(folder)


def test_what_is_stored_is_what_every_rater_would_say_until_it_leaves(
    rendered: Path, answered: list[tuple[object, ...]]
) -> None:
    study, segments = StudyFolder(rendered).study(), StudyFolder(rendered).segments()
    said: list[tuple[object, ...]] = []
    for name in sorted({str(entry[0]) for entry in answered}):
        comparison, number, *_ = name.split()
        rater = Rater(population=default_population(study), seed=3, name=name)
        plan = pair_plan(
            study, segments, other=comparison.removeprefix("rule_based-"), number=int(number)
        )
        conduct = Conduct(rater=rater, trials=len(plan), coverage=1)
        stays = len(plan) if conduct.returns else (conduct.leaves_at or len(plan) + 1) - 1
        for trial in plan[:stays]:
            seen = SeenTrial(
                position=trial.position, segment=trial.segment.name, stimuli=trial.stimuli
            )
            given = judge(study, rater, seen).values
            said.extend(
                (name, trial.position, question, *trial.conditions, value)
                for (question, _), value in given.items()
            )
    assert sorted(said, key=str) == sorted(answered, key=str)


@pytest.mark.slow
def test_answers_depend_on_the_seed_and_not_on_who_comes_first(
    folder: StudyFolder, answered: list[tuple[object, ...]]
) -> None:
    rehearse(folder, seed=3, workers=1)
    assert what_was_answered(folder) == answered


@pytest.mark.slow
def test_an_interrupted_rehearsal_is_finished_with_the_same_answers(
    folder: StudyFolder, answered: list[tuple[object, ...]]
) -> None:
    def interrupt(done: int, _total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rehearse(folder, seed=3, workers=4, on_done=interrupt)
    assert not servers(folder)
    assert len(what_was_answered(folder)) < len(answered)
    result = rehearse(folder, seed=3)
    assert result.kept >= 2
    assert result.completed == 6
    assert "gone on with" in result.note
    assert what_was_answered(folder) == answered


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
def test_a_killed_rehearsal_leaves_no_server_and_can_be_finished(
    folder: StudyFolder, answered: list[tuple[object, ...]], how: signal.Signals
) -> None:
    program = (
        "import sys; from pathlib import Path; "
        "from studyapp.definition.folder import StudyFolder; "
        "from studyapp.rehearsal.run import rehearse; "
        "rehearse(StudyFolder(Path(sys.argv[1])), seed=3, workers=2, speed=4)"
    )
    rehearsing = subprocess.Popen([sys.executable, "-c", program, str(folder.root)])
    try:
        wait_for("a server", happens=lambda: servers(folder))
        wait_for("an answer", happens=lambda: folder.rehearsal.exists() and len(answers(folder)))
    finally:
        os.kill(rehearsing.pid, how)
        rehearsing.wait(120)
    wait_for("the server's end", happens=lambda: not servers(folder))
    before = what_was_answered(folder)
    rehearse(folder, seed=3)
    after = what_was_answered(folder)
    assert 0 < len(before) < len(after)
    assert set(before) <= set(after)
    assert after == answered


@pytest.mark.slow
def test_a_finished_rehearsal_is_kept_as_it_is(folder: StudyFolder) -> None:
    rehearse(folder, participants=1, seed=3)
    before = answers(folder)
    result = rehearse(folder, participants=1, seed=3)
    assert (result.completed, result.kept, result.probes) == (2, 2, ())
    pd.testing.assert_frame_equal(answers(folder), before)


@pytest.mark.slow
def test_more_participants_can_be_added_later(
    folder: StudyFolder, answered: list[tuple[object, ...]]
) -> None:
    first = rehearse(folder, participants=1, seed=3)
    assert first.completed == 2
    assert set(what_was_answered(folder)) < set(answered)
    rehearse(folder, participants=3, seed=3)
    assert what_was_answered(folder) == answered
    fewer = rehearse(folder, participants=1, seed=3)
    assert (fewer.completed, fewer.kept) == (6, 6)


@pytest.mark.slow
def test_another_seed_answers_differently(
    folder: StudyFolder, answered: list[tuple[object, ...]]
) -> None:
    rehearse(folder, seed=4)
    asked = {entry[:-1] for entry in what_was_answered(folder) if "again" not in str(entry[0])}
    assert asked & {entry[:-1] for entry in answered}
    assert what_was_answered(folder) != answered


def test_real_answers_are_never_touched(
    folder: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = sqlite_url(folder.root / "elsewhere.db")
    monkeypatch.setenv("DATABASE_URL", real)
    folder.responses.write_bytes(b"real answers")
    rehearse(folder, participants=1)
    assert folder.responses.read_bytes() == b"real answers"
    assert not (folder.root / "elsewhere.db").exists()
    assert list(folder.root.glob("responses.db*")) == [folder.responses]


def test_a_rehearsal_with_more_participants_than_places_is_refused(folder: StudyFolder) -> None:
    with pytest.raises(InputError, match=r"4 participants .* 3 places.*study\.toml|study\.toml.*4"):
        rehearse(folder, participants=4)
    assert not folder.rehearsal.exists()


def test_a_study_without_its_videos_is_not_rehearsed(folder: StudyFolder) -> None:
    (folder.videos / "pairs" / "002.mp4").unlink()
    with pytest.raises(InputError, match=r"002\.mp4.*motionjury render"):
        rehearse(folder)
    assert not folder.rehearsal.exists()


@pytest.mark.slow
def test_a_server_that_dies_is_told_and_the_rehearsal_can_be_finished(
    folder: StudyFolder, answered: list[tuple[object, ...]]
) -> None:
    def kill_the_server(done: int, _total: int) -> None:
        if done == 1:
            for process in servers(folder):
                os.kill(process, signal.SIGKILL)

    with pytest.raises(InputError, match=r"does not answer.*goes on where it was"):
        rehearse(folder, seed=3, workers=2, on_done=kill_the_server)
    rehearse(folder, seed=3)
    assert what_was_answered(folder) == answered


@pytest.mark.slow
def test_two_rehearsals_of_one_study_do_not_disturb_each_other(folder: StudyFolder) -> None:
    def rehearse_again(done: int, _total: int) -> None:
        if done == 1:
            with pytest.raises(InputError, match="being rehearsed already"):
                rehearse(folder, seed=4)

    rehearse(folder, participants=1, seed=3, on_done=rehearse_again)
    assert read_truth(folder.rehearsal_truth).seed == 3
    assert rehearse(folder, participants=1, seed=3).kept == 2
