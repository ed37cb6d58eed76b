"""Looking at a page: in every size, light and dark, and with axe-core's eyes."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, ViewportSize

LAPTOP: ViewportSize = {"width": 1366, "height": 768}
SIZES: dict[str, ViewportSize] = {
    "laptop": LAPTOP,
    "desktop": {"width": 1920, "height": 1080},
    "phone": {"width": 390, "height": 844},
}
CONTRAST = {"runOnly": {"type": "rule", "values": ["color-contrast"]}}
SEVERE = ("serious", "critical")
SCHEMES: tuple[Literal["dark"], Literal["light"]] = ("dark", "light")


def photograph(page: Page, name: str, *, resized: bool = True) -> None:
    """Take the page, where screenshots are wanted.

    In every size, light and dark, and left light and as wide as a laptop; or once, as it is.
    """
    if "SCREENSHOTS" not in os.environ:
        return
    folder = Path(os.environ["SCREENSHOTS"])
    folder.mkdir(parents=True, exist_ok=True)
    if not resized:
        page.screenshot(path=folder / f"{name}.png")
        return
    for size, viewport in SIZES.items():
        page.set_viewport_size(viewport)
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            path = folder / f"{name}-{size}-{scheme}.png"
            page.screenshot(path=path, full_page=size == "phone")
    page.set_viewport_size(LAPTOP)


def barriers(page: Page) -> list[str]:
    """Return what axe-core finds severe on the page, light and dark."""
    found = []
    for scheme, options in zip(SCHEMES, (CONTRAST, {"resultTypes": ["violations"]}), strict=True):
        page.emulate_media(color_scheme=scheme)
        results = Axe().run(page, options=options).response
        found += [
            f"{scheme}: {violation['id']} at {node['target']}: {node['failureSummary']}"
            for violation in results["violations"]
            if violation["impact"] in SEVERE
            for node in violation["nodes"]
        ]
    return found
