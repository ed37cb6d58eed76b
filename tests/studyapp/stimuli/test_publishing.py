"""Videos are uploaded to a store under names and in an order that reveal nothing."""

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.session.served_study import ServedStudy
from studyapp.stimuli.publishing import MARK_BYTES, Publication, publish, require_loading
from studyapp.study.folder import StudyFolder
from studyapp.study.media import read_stimuli
from studyapp.web.media_store import FILE, Place, PublishedVideo, digests_of, read_published
from tests.support.servers.s3_stand_in import BUCKET, SECRET, Store, forget_keys
from tests.support.studies.tiny_study import write_pair_video

ORIGIN = "https://study.example.org"


def place_in(store: Store, folder: str = "my-study/") -> Place:
    return Place(bucket=BUCKET, folder=folder, endpoint=store.endpoint)


def silent(_done: int, _total: int) -> None:
    """Show nothing."""


def videos_of(study: Path) -> dict[str, PublishedVideo]:
    published = read_published(study)
    assert published is not None
    return published.videos


def names_of(study: Path) -> set[str]:
    return {name for video in videos_of(study).values() for name in video.names}


def test_every_video_is_stored_as_often_as_a_participant_sees_it(
    tiny_study: Path, s3_store: Store
) -> None:
    done = publish(StudyFolder(tiny_study), place_in(s3_store), silent)

    # Sixteen videos; the practice trial's video comes again at the end.
    assert done == Publication(stored=32, kept=0)
    assert names_of(tiny_study) == set(s3_store.objects)
    served = ServedStudy.read(tiny_study)
    for content, digest in digests_of(served).items():
        first, second = videos_of(tiny_study)[digest].names
        own = served.videos[content].file.read_bytes()
        for name in (first, second):
            stored = s3_store.objects[name]
            assert stored.content[:-MARK_BYTES] == own
            assert stored.headers["Content-Type"] == "video/mp4"
            assert not [header for header in stored.headers if "meta" in header.lower()]
        assert s3_store.objects[first].etag != s3_store.objects[second].etag


def test_neither_names_nor_storage_order_reveal_anything(tiny_study: Path, s3_store: Store) -> None:
    publish(StudyFolder(tiny_study), place_in(s3_store), silent)

    by_age = list(s3_store.objects)
    assert len({len(name) for name in by_age}) == 1
    record = (tiny_study / FILE).read_text()
    for told in (*(pair.file for pair in read_stimuli(tiny_study / "stimuli.json").pairs), SECRET):
        assert told not in record
        assert not [name for name in by_age if told in name]
    videos = videos_of(tiny_study).values()
    by_record = [video.names[which] for which in (0, 1) for video in videos]
    assert sorted(by_age) == sorted(by_record)
    # By chance once in 10^35: the number of orders of 32 names.
    assert by_age not in (by_record, sorted(by_record))


def test_an_interrupted_run_resumes_and_a_second_run_does_nothing(
    tiny_study: Path, s3_store: Store
) -> None:
    folder = StudyFolder(tiny_study)
    s3_store.takes = 10
    with pytest.raises(InputError, match=r"the store does not store .*QuotaExceeded") as found:
        publish(folder, place_in(s3_store), silent)
    assert SECRET not in str(found.value)
    before = dict(s3_store.objects)
    s3_store.takes = None

    assert publish(folder, None, silent) == Publication(stored=22, kept=10)
    assert publish(folder, None, silent) == Publication(stored=0, kept=32)
    assert before.items() <= s3_store.objects.items()


def test_rendering_one_video_again_republishes_all(tiny_study: Path, s3_store: Store) -> None:
    """If stored alone, its age would reveal its condition."""
    folder = StudyFolder(tiny_study)
    publish(folder, place_in(s3_store), silent)
    before = names_of(tiny_study)
    write_pair_video(tiny_study / "videos" / "pairs" / "003.mp4", shade=5)

    done = publish(folder, None, silent)

    assert done == Publication(stored=32, kept=0)
    assert not before & names_of(tiny_study)


def test_a_store_must_let_the_studys_pages_load_and_nobody_without_a_signature(
    tiny_study: Path, s3_store: Store
) -> None:
    folder = StudyFolder(tiny_study)
    publish(folder, place_in(s3_store, ""), silent)
    with pytest.raises(InputError, match=r"does not let pages of .* load from it"):
        require_loading(folder, ORIGIN)
    s3_store.origins = [ORIGIN]
    require_loading(folder, ORIGIN)
    s3_store.public = True
    with pytest.raises(InputError, match="anybody can load from it"):
        require_loading(folder, ORIGIN)


def test_wrong_keys_and_a_missing_store_are_reported(
    tiny_study: Path, s3_store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = StudyFolder(tiny_study)
    with pytest.raises(InputError, match=r"Give the bucket, such as s3://"):
        publish(folder, None, silent)
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "wrong")
    forget_keys(monkeypatch)
    with pytest.raises(InputError, match=r"does not list what it holds: SignatureDoesNotMatch"):
        publish(folder, place_in(s3_store), silent)
    monkeypatch.setenv("AWS_MAX_ATTEMPTS", "1")
    nowhere = Place(bucket=BUCKET, folder="x/", endpoint="http://127.0.0.1:9")
    with pytest.raises(InputError, match=r"cannot be asked .* AWS_ACCESS_KEY_ID"):
        publish(folder, nowhere, silent)
