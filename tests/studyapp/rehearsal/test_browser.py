"""Simulated participants in a real browser."""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import select

from motion.errors import InputError
from studyapp.database.tables import Video
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.browser import require_browser
from studyapp.rehearsal.run import rehearse
from studyapp.rehearsal.simulation.population import default_population
from studyapp.study.folder import StudyFolder
from tests.finished_study import write_short_video
from tests.functional.browsing import IN_A_BROWSER
from tests.studyapp.rehearsal.protocol_studies import write_study
from tests.studyapp.rehearsal.steps import require_stored_as_acknowledged
from tests.support.stored import opened

SEED = 3


def in_a_browser(folder: StudyFolder) -> None:
    """Let one attentive participant take part in a browser, and require that all is stored."""
    people = replace(default_population(folder.study()), kinds={})
    result = rehearse(folder, participants=1, population=people, seed=SEED, browsers=1)
    arms = len(folder.study().arms)
    assert (result.completed, result.kept) == (arms, 0)
    ledger = Ledger(folder.acknowledged)
    assert len(ledger.read().codes) == arms
    with opened(folder.rehearsal) as database:
        require_stored_as_acknowledged(database, ledger, arms)
        with database.reading() as session:
            assert all(video.watch_record for video in session.scalars(select(Video)))


class TestInChromium:
    pytestmark = IN_A_BROWSER

    def test_sliders_labels_reasons_and_forms_are_filled_in_as_a_person_does(
        self, tmp_path: Path
    ) -> None:
        write_short_video(tmp_path / "short.mp4", seconds=0.5)
        in_a_browser(write_study(tmp_path / "study", "ratings", tmp_path / "short.mp4"))


def test_without_playwright_it_is_said_what_to_install(
    folder: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "playwright.sync_api", None)
    with pytest.raises(InputError, match=r"Playwright.*missing.*pip install.*playwright install"):
        rehearse(folder, browsers=1)
    assert not folder.rehearsal.exists()


def test_without_a_browser_it_is_said_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: str(tmp_path / name))
    with pytest.raises(InputError, match=r"no browser could be started.*playwright install"):
        require_browser()
