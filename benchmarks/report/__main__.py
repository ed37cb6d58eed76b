"""Time and memory for a report of a million answers: ``python -m benchmarks.report``.

Prints ``name: value`` lines: processor seconds, wall-clock seconds and peak memory of a separate
process for each protocol's table and for a study's database.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from analysis.answers.table import LAYOUTS
from benchmarks.report.filled_study import fill_study
from benchmarks.report.made_answers import made_table

ANSWERS: Final = 1_000_000
STUDY: Final = "study"


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Measure reports of very many answers.")
    parser.add_argument("--answers", type=int, default=ANSWERS)
    parser.add_argument("--only", choices=[*LAYOUTS, STUDY], help="measure this one alone")
    args = parser.parse_args(arguments)
    print(f"answers: {args.answers}", flush=True)
    for name in [args.only] if args.only else [*LAYOUTS, STUDY]:
        with tempfile.TemporaryDirectory() as folder:
            _measure(name, args.answers, Path(folder))


def _measure(name: str, answers: int, folder: Path) -> None:
    if name == STUDY:
        fill_study(folder, answers)
        command = [str(folder)]
    else:
        table = folder / "answers.parquet"
        made_table(name, answers).to_parquet(table)
        command = ["--responses", str(table), "--protocol", name, "--out", str(folder / "out")]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    done = subprocess.run(  # noqa: S603 - our own command line
        [sys.executable, "-c", _REPORT, *command], check=True, capture_output=True, text=True
    )
    seconds = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"report_{name}_processor_s: {processor:.1f}")
    print(f"report_{name}_s: {seconds:.1f}")
    print(f"report_{name}_gib: {int(done.stdout.split()[-1]) / 2**20:.2f}", flush=True)


_REPORT: Final = """
import resource, sys
from studyapp.cli.main import main
sys.argv[:1] = ["motionjury", "report"]
main()
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


if __name__ == "__main__":
    main()
