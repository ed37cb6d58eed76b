from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder
from studyapp.stages.reporting import report
from tests.finished_study import COMMON, PROTOCOLS


@pytest.mark.parametrize(
    ("protocol", "named"),
    [
        ("pairwise", "compares pairs with comparisons = 'all_pairs'"),
        ("rating", "is a rating study"),
        ("ranking", "is a ranking study"),
        ("mismatch", "is a mismatch study"),
    ],
)
def test_a_study_that_the_report_does_not_cover_is_told_in_one_sentence(
    tmp_path: Path, protocol: str, named: str
) -> None:
    keys, tables = PROTOCOLS[protocol].split("\n\n", 1)
    (tmp_path / "study.toml").write_text(f"{keys}\n{COMMON}\n{tables}", encoding="utf-8")

    with pytest.raises(InputError, match=rf"the report covers.*this {named}.*motionjury export"):
        report(StudyFolder(tmp_path))
