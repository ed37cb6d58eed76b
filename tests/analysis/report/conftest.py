from collections.abc import Iterator

import pytest

from analysis.report.figures import style


@pytest.fixture(scope="module", autouse=True)
def quick_fonts() -> Iterator[None]:
    """Skip font subsets, which only printed figures need."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(style.STYLE, "pdf.fonttype", 3)
        yield
