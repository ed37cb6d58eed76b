from __future__ import annotations

from pathlib import Path

from studyapp.web.media_store import FILE
from tests.support.command_line import run
from tests.support.servers.s3_stand_in import BUCKET, SECRET, Store

ADDRESS = "https://study.example.org/studies/one/"


def test_videos_are_uploaded_and_loaded_as_by_a_browser(tiny_study: Path, s3_store: Store) -> None:
    assert "no bucket was given" in run("publish-media", tiny_study, status=1)
    given = ("--endpoint", s3_store.endpoint)
    first = run("publish-media", tiny_study, f"s3://{BUCKET}/a", *given, "--address", ADDRESS)
    again = run("publish-media", tiny_study)
    (tiny_study / FILE).unlink()
    anew = run("publish-media", tiny_study, f"s3://{BUCKET}/a/", *given, "--remove-unused")

    assert "Uploaded 32 copies; 0 were already there." in first
    assert "Pages of https://study.example.org can load them" in first
    assert s3_store.origins == ["https://study.example.org"]
    assert "Uploaded 0 copies; 32 were already there." in again
    assert "Removed 32 unused objects" in anew
    assert len(s3_store.objects) == 32
    assert SECRET not in first + again + anew
