from __future__ import annotations

from pathlib import Path

import grimp
import pytest

from renderer.version import BODY_SOURCES, VIDEO_SOURCES

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def imports() -> grimp.ImportGraph:
    return grimp.build_graph("motion", "renderer", cache_dir=None)


def source_of(module: str) -> str:
    plain = Path(*module.split(".")).with_suffix(".py")
    path = plain if (ROOT / plain).exists() else Path(*module.split("."), "__init__.py")
    return path.as_posix()


@pytest.mark.parametrize(
    ("sources", "beginnings"),
    [
        (VIDEO_SOURCES, ["renderer.clip_video", "renderer.dub", "renderer.pair"]),
        (BODY_SOURCES, ["renderer.avatar.assembly"]),
    ],
)
def test_every_module_that_is_imported_to_draw_counts(
    imports: grimp.ImportGraph, sources: tuple[str, ...], beginnings: list[str]
) -> None:
    needed = set(beginnings)
    for beginning in beginnings:
        needed |= imports.find_upstream_modules(beginning)
    assert {source_of(module) for module in needed} <= set(sources)


@pytest.mark.parametrize(
    "source",
    ["canvas", "encoder", "frames", "loudness", "look", "opengl", "pair", "surface"],
)
def test_what_can_change_pixels_or_sound_counts(source: str) -> None:
    assert f"renderer/{source}.py" in VIDEO_SOURCES


@pytest.mark.parametrize("part", ["bench", "job", "jobs", "stills", "figures", "formats/bvh"])
def test_what_can_change_neither_does_not_count(part: str) -> None:
    assert not [source for source in VIDEO_SOURCES if part in source.split("/", 1)[1].split(".")]
    assert not [source for source in VIDEO_SOURCES if f"/{part}/" in source]
