from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.web.media_store import FILE
from tests.support.command_line import run
from tests.support.servers.s3_stand_in import BUCKET, SECRET, Store

ADDRESS = "https://study.example.org/studies/one/"


def test_videos_are_uploaded_and_loaded_as_by_a_browser(tiny_study: Path, s3_store: Store) -> None:
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


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (["https://example.org/bucket"], "not the name of a bucket"),
        (["s3://Bucket_1"], "not the name of a bucket"),
        (["s3://bucket/../other"], "not the name of a bucket"),
        (["s3://bucket", "--endpoint", "http://s3.example.org"], "only load videos over https"),
        (["s3://bucket", "--address", "study.example.org"], "not the address of a study"),
        ([], "no bucket was given"),
    ],
)
def test_an_invalid_place_is_refused_before_any_request(
    tiny_study: Path, s3_store: Store, arguments: list[str], error: str
) -> None:
    assert error in run("publish-media", tiny_study, *arguments, status=1)
    assert s3_store.asked == []
    assert not (tiny_study / FILE).exists()
