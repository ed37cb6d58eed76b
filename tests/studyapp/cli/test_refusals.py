"""Command lines that cannot be done: one sentence each, before anything is written or sent."""

import shlex
from pathlib import Path

import pytest

from studyapp.study.study_file import new_study
from tests.support.command_line import refused
from tests.support.studies.takes import write_motion, write_speech

REFUSED: dict[str, dict[str, str]] = {
    "check": {"study --address study.example.org": "not the address of a study"},
    "generate": {
        "": "give a study folder, or all of --generator",
        "--generator static": "give a study folder, or all of --generator",
        "study --generator static": "the generators of a study are set in its study.toml",
        "study --seed 2": "and so is the seed",
        "--generator static --speech a.wav --speech more/a.wav --out new": "two files of speech",
        "--generator diffsheg --speech a.wav --out new": "checkpoint: is missing",
        "--generator broken --speech a.wav --out new": "changes another condition's motion",
        "--generator static --speech a.wav --out motion": "this motion was not generated",
    },
    "corpus": {"new --sentences 12": "sentences"},
    "import": {
        "a.bvh study --condition x --speech a.wav": "--speaker and --emotion",
        "a.bvh study --condition x --segment 10": "--segment",
        "a.bvh study --condition x --joints none.toml": "none.toml: No such file or directory",
        "a.bvh study --condition x --speech torn.wav --speaker a --emotion neutral": "torn.wav",
    },
    "init": {
        "new --condition ours": "does not say where its motion comes from",
        "new --condition ours=magic --condition b=files": "unknown source 'magic'",
        "new --condition a=mismatched --condition b=files": "needs the condition",
        "new --condition a=files --condition a=files": "given twice",
        "new --condition a=files": "needs at least 2, not 1",
        "new --condition a=diffsheg --condition b=files": "needs its weights",
        "new --condition a=files --condition b=files --reference c": "is not a condition",
        "new --template ranking --condition a=files --condition b=files --reference a": (
            "needs at least 2, not 1"
        ),
        "new --template rating --trials 5": "has no key 'trials'",
        "new --pay 2.50": "not an amount with a currency",
        "new --recruit mturk --pay '3 EUR' --minutes 9": "Mechanical Turk pays in USD, not in EUR",
        "study": "already exists",
    },
    "metrics": {
        "": "give either a study or --generated",
        "--generated motion --out scores.xlsx": ".csv or .parquet",
        "--generated motion --preset genea --evaluator emage=none.bin": "no such file",
    },
    "plan": {
        "study --participants 6": "(--items 24,48 tries",
        "study --items 8 --effect 0.2,nan": "'nan' is not a number",
    },
    "publish-media": {
        "study https://example.org/bucket": "not the name of a bucket",
        "study s3://bucket/../other": "not the name of a bucket",
        "study s3://bucket --endpoint http://s3.example.org": "only load videos over https",
    },
    "recruit": {"study create --address study.example.org": "not the address of a study"},
    "report": {
        "": "there is nothing to report",
        "--responses a.csv --out new": "--responses FILE --protocol NAME",
        "--responses none.csv --out new --protocol rating": "no such file",
        "study --out new --margin 1": "--out, --margin cannot be given with a study",
    },
    "train": {
        "static": "No such command 'static'",
        "evaluator motion --data nowhere": "nowhere: there is no such folder",
        "evaluator face --data . --channels both": "--channels is for the kind motion",
        "evaluator motion --data . --learning-rate 0": "0<x<=1",
        "diffsheg --data . --out a.wav": "this file exists, but not the run",
    },
    "serve": {
        "study --address https://x.org/a%20b": "not a path that a study can be served below",
        "study --address x.org/one": "not the address of a study",
    },
    "export": {
        "study": "no database of answers yet. If the study is served with DATABASE_URL",
        "study --rehearsal": "nothing has been rehearsed",
        "study --out new.xlsx": "neither in .csv nor in .parquet",
        "study --folder new --with-recruiter-ids": "cannot be given with --folder",
        "study --with-videos": "cannot be given with tables, only with --folder",
    },
    "backup": {"study new.zip": "no database of answers yet. If the study is served with DATABASE"},
}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a read-only folder with a study, speech and motion."""
    folder = tmp_path_factory.mktemp("place")
    new_study(folder / "study" / "study.toml", name="study")
    write_motion(folder / "motion" / "a.npz", 1.0)
    for name in ("a.wav", "more/a.wav"):
        (folder / name).parent.mkdir(exist_ok=True)
        write_speech(folder / name, 1)
    for name in ("torn.wav", "a.bvh"):
        (folder / name).write_text("this is neither sound nor motion")
    return folder


@pytest.mark.parametrize(
    ("command", "options", "error"),
    [(name, *each) for name, errors in REFUSED.items() for each in errors.items()],
)
def test_an_impossible_request_is_refused_and_writes_nothing(
    place: Path, monkeypatch: pytest.MonkeyPatch, command: str, options: str, error: str
) -> None:
    monkeypatch.chdir(place)
    before = {path: path.stat().st_mtime_ns for path in place.rglob("*")}

    assert error in refused(command, *shlex.split(options))

    assert {path: path.stat().st_mtime_ns for path in place.rglob("*")} == before
