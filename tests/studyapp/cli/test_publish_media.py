from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from motion.errors import InputError
from studyapp.cli.publish_media_command import command
from studyapp.web.media_store import FILE
from tests.studyapp.s3_stand_in import BUCKET, SECRET, Store

ADDRESS = "https://study.example.org/studies/one/"


def publish(*arguments: object) -> Result:
    return CliRunner().invoke(command, [*map(str, arguments)], catch_exceptions=False)


def test_videos_are_published_and_tried_as_a_browser_will(
    tiny_study: Path, s3_store: Store
) -> None:
    first = publish(
        tiny_study, f"s3://{BUCKET}/my-study", "--endpoint", s3_store.endpoint, "--address", ADDRESS
    )
    again = publish(tiny_study)
    (tiny_study / FILE).unlink()
    anew = publish(
        tiny_study, f"s3://{BUCKET}/my-study/", "--endpoint", s3_store.endpoint, "--remove-unused"
    )

    assert "Stored 32 copies; 0 were there." in first.output
    assert "Pages of https://study.example.org can load them" in first.output
    assert s3_store.origins == ["https://study.example.org"]
    assert "Stored 0 copies; 32 were there." in again.output
    assert "Removed 32 objects" in anew.output
    assert len(s3_store.objects) == 32
    assert SECRET not in first.output + again.output + anew.output


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
    with pytest.raises(InputError, match=said):
        publish(tiny_study, *arguments)

    assert s3_store.asked == []
    assert not (tiny_study / FILE).exists()


def test_an_endpoint_without_a_bucket_is_refused(tiny_study: Path) -> None:
    found = publish(tiny_study, "--endpoint", "https://s3.example.org")

    assert found.exit_code == 2
    assert "belong to a bucket" in found.output
