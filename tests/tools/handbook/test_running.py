from pathlib import Path

import pytest

from tools.handbook.guide import GUIDE
from tools.handbook.running import run_page


@pytest.mark.slow
def test_the_guides_first_steps_work_as_printed(tmp_path: Path) -> None:
    page = GUIDE.read_text(encoding="utf-8")

    assert run_page(page, tmp_path, until="**Recorded motion.**") == page, "run 'make guide'"
