"""Whole small rehearsals through the real server."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import chain, count, product
from pathlib import Path

import pandas as pd
import pytest
from sqlalchemy import func, select

from motion.errors import InputError
from studyapp.database.engine import sqlite_url
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Response
from studyapp.rehearsal.eyes import rater_name
from studyapp.rehearsal.run import rehearse
from studyapp.rehearsal.server import rehearsal_server
from studyapp.rehearsal.simulation.population import default_population
from studyapp.rehearsal.simulation.raters import Rater, judge
from studyapp.rehearsal.simulation.truth import read_truth
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.conditions import comparison_name
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.made_study import pair_plan
from tests.support.studies.stored import opened, reading

ANSWER = ["rater", "position", "question", "left_condition", "right_condition", "value"]


def answers(folder: StudyFolder) -> pd.DataFrame:
    """Every stored answer, and which rater gave it."""
    with opened(folder.rehearsal) as database:
        table = read_once(database, responses_table)
        with database.reading() as session:
            raters = {
                study_session.id: rater_name(session, study_session)
                for study_session in session.scalars(select(StudySession))
            }
    return table.assign(rater=table["study_session"].map(raters))


def what_was_answered(folder: StudyFolder) -> list[tuple[object, ...]]:
    table = answers(folder)[ANSWER]
    return sorted(table.itertuples(index=False, name=None), key=str)


def stored(folder: StudyFolder) -> int:
    """How many answers are stored."""
    if not folder.rehearsal.exists():
        return 0
    with reading(folder.rehearsal) as session:
        return session.scalars(select(func.count()).select_from(Response)).one()


def completed(folder: StudyFolder) -> int:
    """How many participants have their completion code."""
    with reading(folder.rehearsal) as session:
        return session.scalars(select(func.count(StudySession.completed_at))).one()


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
def said(rendered: Path) -> list[tuple[object, ...]]:
    """Answers of the raters of seed 3 in all places, including those who follow one who leaves."""
    folder = StudyFolder(rendered)
    study, segments = folder.study(), folder.segments()
    assert isinstance(study, PairwiseStudy)
    population = default_population(study)
    rows: list[tuple[object, ...]] = []
    for comparison, number in product(study.others, range(study.participants_per_comparison)):
        plan = pair_plan(study, segments, other=comparison, number=number)
        place = f"{comparison_name(study.reference, comparison)} {number}"
        for name in chain([place], (f"{place} again {earlier}" for earlier in count(1))):
            rater = Rater(population=population, seed=3, name=name)
            leaves_at = None if rater.returns else rater.leaves_at(len(plan))
            for trial in plan[: leaves_at and leaves_at - 1]:
                given = judge(study, rater, trial).values
                rows.extend(
                    (name, trial.position, question, *trial.conditions, value)
                    for (question, _), value in given.items()
                )
            if leaves_at is None:
                break
    return sorted(rows, key=str)


@pytest.mark.slow
def test_participants_can_be_added_without_touching_real_answers(
    folder: StudyFolder, said: list[tuple[object, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Raters who leave are replaced, and answers do not depend on the order of arrival."""
    monkeypatch.setenv("DATABASE_URL", sqlite_url(folder.root / "elsewhere.db"))
    folder.responses.write_bytes(b"real answers")
    first = rehearse(folder, participants=1, seed=3, workers=1)
    assert (first.completed, first.kept) == (2, 0)
    assert set(what_was_answered(folder)) < set(said)

    seen: list[tuple[int, int]] = []
    rehearse(folder, seed=3, on_done=lambda done, total: seen.append((done, total)))

    assert what_was_answered(folder) == said
    done, total = zip(*seen, strict=True)
    assert list(done) == sorted(done)
    assert done[-1] == total[-1]
    before = answers(folder)
    assert before.groupby("comparison")["study_session"].nunique().min() >= 3
    fewer = rehearse(folder, participants=1, seed=3)
    assert (fewer.completed, fewer.kept) == (6, 6)
    pd.testing.assert_frame_equal(answers(folder), before)
    assert not servers(folder)
    assert folder.responses.read_bytes() == b"real answers"
    assert not (folder.root / "elsewhere.db").exists()
    assert list(folder.root.glob("responses.db*")) == [folder.responses]


def interrupt(folder: StudyFolder) -> None:
    """Press Ctrl-C, and meanwhile try to rehearse the study a second time."""

    def press(done: int, _total: int) -> None:
        if done > known:
            with pytest.raises(InputError, match="already being rehearsed"):
                rehearse(folder, seed=4)
            raise KeyboardInterrupt

    known = completed(folder)
    with pytest.raises(KeyboardInterrupt):
        rehearse(folder, seed=3, workers=2, on_done=press)
    assert read_truth(folder.rehearsal_truth).seed == 3


def kill_the_server(folder: StudyFolder) -> None:
    """Kill all processes of the server once another person has finished."""

    def kill(done: int, _total: int) -> None:
        if done > known:
            for process in servers(folder):
                os.kill(process, signal.SIGKILL)

    known = completed(folder)
    with pytest.raises(InputError, match=r"no longer answers.*Run the command again to continue"):
        rehearse(folder, seed=3, workers=2, on_done=kill)


def kill(folder: StudyFolder) -> None:
    """Kill the rehearsing program once somebody has answered."""
    program = (
        "import sys; from pathlib import Path; "
        "from studyapp.study.folder import StudyFolder; "
        "from studyapp.rehearsal.run import rehearse; "
        "rehearse(StudyFolder(Path(sys.argv[1])), seed=3, workers=2, speed=4)"
    )
    known = stored(folder)
    rehearsing = subprocess.Popen([sys.executable, "-c", program, str(folder.root)])
    try:
        wait_for("a server", happens=lambda: servers(folder))
        wait_for("an answer", happens=lambda: stored(folder) > known)
    finally:
        rehearsing.kill()
        rehearsing.wait(120)


@pytest.mark.slow
def test_a_stopped_rehearsal_leaves_no_server_and_can_be_finished(
    folder: StudyFolder, said: list[tuple[object, ...]]
) -> None:
    before: set[tuple[object, ...]] = set()
    for stop in (kill, kill_the_server, interrupt):
        stop(folder)
        wait_for("the server's end", happens=lambda: not servers(folder))
        after = set(what_was_answered(folder))
        assert before < after < set(said)
        before = after
    kept = completed(folder)
    result = rehearse(folder, seed=3)
    assert (result.completed, result.kept) == (6, kept)
    assert "is continued" in result.note
    assert what_was_answered(folder) == said


def test_a_rehearsal_with_more_participants_than_places_is_refused(folder: StudyFolder) -> None:
    with pytest.raises(InputError, match=r"4 participants .* 3 places.*study\.toml|study\.toml.*4"):
        rehearse(folder, participants=4)
    assert not folder.rehearsal.exists()


def test_a_server_that_cannot_start_says_why(folder: StudyFolder) -> None:
    folder.stimuli.write_text("{")
    with (
        pytest.raises(InputError, match=r"did not start.*stimuli\.json"),
        rehearsal_server(folder, speed=100),
    ):
        raise AssertionError("it is served")
