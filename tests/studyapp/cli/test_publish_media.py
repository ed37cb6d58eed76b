from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.web.media_store import FILE
from tests.support.command_line import run
from tests.support.servers.s3_stand_in import BUCKET, SECRET, Store

ADDRESS = "https://study.example.org/studies/one/"


def test_videos_are_published_and_tried_as_a_browser_will(
    tiny_study: Path, s3_store: Store
) -> None:
    given = ("--endpoint", s3_store.endpoint)
    first = run("publish-media", tiny_study, f"s3://{BUCKET}/a", *given, "--address", ADDRESS)
    again = run("publish-media", tiny_study)
    (tiny_study / FILE).unlink()
    anew = run("publish-media", tiny_study, f"s3://{BUCKET}/a/", *given, "--remove-unused")

    assert "Stored 32 copies; 0 were there." in first
    assert "Pages of https://study.example.org can load them" in first
    assert s3_store.origins == ["https://study.example.org"]
    assert "Stored 0 copies; 32 were there." in again
    assert "Removed 32 objects" in anew
    assert len(s3_store.objects) == 32
    assert SECRET not in first + again + anew


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["https://example.org/bucket"], "this names no bucket"),
        (["s3://Bucket_1"], "this names no bucket"),
        (["s3://bucket/../other"], "this names no bucket"),
        (["s3://bucket", "--endpoint", "http://s3.example.org"], "by https alone"),
        (["s3://bucket", "--address", "study.example.org"], "not an address of a study"),
        ([], "nobody has said where"),
    ],
)
def test_a_wrong_place_is_said_before_anything_is_asked(
    tiny_study: Path, s3_store: Store, arguments: list[str], said: str
) -> None:
    assert said in run("publish-media", tiny_study, *arguments, status=1)
    assert s3_store.asked == []
    assert not (tiny_study / FILE).exists()
