"""What all tests may use."""

import gc
import os
import shutil
import signal
from collections.abc import Generator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.support.studies.tiny_study import write_tiny_study

# Machines that run tests may be busy; how long one example takes says nothing about the code. In
# continuous integration each run draws the same examples, so that only the change matters.
settings.register_profile(
    "patient",
    deadline=None,
    derandomize="CI" in os.environ,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("patient")

# A shell in the background ignores interrupts, and so would whatever the tests start and interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)

BEGIN_LONG_WITHIN = 0.8
"""Share of the short files, by the end of which all long ones have begun."""


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """What is imported to collect tests stays: never look through it for garbage."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(10_000)
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """In continuous integration, rerun a failed browser test once; spread long files over a run.

    They often wait, and short ones beside them use the processors meanwhile. Only short ones come
    at the end, where they keep parallel processes evenly busy.
    """
    if "CI" in os.environ:
        for item in items:
            if item.get_closest_marker("browser"):
                item.add_marker(pytest.mark.flaky(reruns=1))
    if hasattr(config, "workerinput"):
        marks = ("slow", "browser")
        slow = {item.path for item in items if any(map(item.get_closest_marker, marks))}
        long = sorted(slow, key=lambda path: ("functional" not in path.parts, path))
        short = sorted({item.path for item in items} - slow)
        places = {path: BEGIN_LONG_WITHIN * number / len(long) for number, path in enumerate(long)}
        places |= {path: number / len(short) for number, path in enumerate(short)}
        items.sort(key=lambda item: places[item.path])


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of real recordings beside the repository, or skip the test."""
    folder = Path(__file__).resolve().parents[1].parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the real recordings (../shared/data) are not here")
    return folder


@pytest.fixture(scope="session")
def tiny_study_template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study folder, made once, of really playing videos; `tiny_study` copies it."""
    folder = tmp_path_factory.mktemp("tiny-study")
    write_tiny_study(folder)
    return folder


@pytest.fixture
def tiny_study(tiny_study_template: Path, tmp_path: Path) -> Path:
    """Return a fresh study folder, ready to be served."""
    folder = tmp_path / "study"
    shutil.copytree(tiny_study_template, folder)
    return folder
