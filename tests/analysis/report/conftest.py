from __future__ import annotations

from collections.abc import Iterator

import pytest

from analysis.report.figures import style


@pytest.fixture(scope="module", autouse=True)
def quick_fonts() -> Iterator[None]:
    """Spare the parts of fonts that only those need who print figures."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(style.STYLE, "pdf.fonttype", 3)
        yield
