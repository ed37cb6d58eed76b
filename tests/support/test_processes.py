from __future__ import annotations

import os
import subprocess
import sys

from tests.support.processes import children, cpu_seconds, family_cpu_seconds, is_running

BUSY = "import time\nwhile time.process_time() < 0.3: pass\n"


def test_the_time_of_children_counts_while_they_run_and_after() -> None:
    code = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {BUSY!r}])\ninput()"
    with subprocess.Popen(
        [sys.executable, "-c", f"{code}"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as parent:
        while family_cpu_seconds(parent.pid) < 0.3 or children(parent.pid):
            assert parent.poll() is None
        assert family_cpu_seconds(parent.pid) >= cpu_seconds(parent.pid) + 0.2
        assert parent.pid in children(os.getpid())
        assert is_running(parent.pid)
        parent.communicate(b"\n")
        assert not is_running(parent.pid)
    assert cpu_seconds(parent.pid) == 0
