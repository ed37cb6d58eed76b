import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from motion.processes import ProcessPool

# Each process runs the head of this program while it loads.
PROGRAM = """
import time
from motion.processes import ProcessPool

print(end=".", flush=True)
time.sleep(1)

if __name__ == "__main__":
    try:
        with ProcessPool(2) as pool:
            list(pool.map(time.sleep, 4 * [600]))
    except KeyboardInterrupt:
        print("interrupted")
"""


def test_processes_that_are_interrupted_while_they_load_end_without_a_word(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    with subprocess.Popen(
        [sys.executable, program],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        process_group=0,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.read(3) == "..."
        os.killpg(process.pid, signal.SIGINT)
        assert process.communicate() == ("interrupted\n", "")


def test_leaving_a_pool_cancels_the_tasks_that_wait() -> None:
    with ProcessPool(1) as pool:
        tasks = [pool.submit(time.sleep, 0.2) for _ in range(9)]
    assert tasks[-1].cancelled()
