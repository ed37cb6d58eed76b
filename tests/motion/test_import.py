import pkgutil
import subprocess
import sys

import motion


def test_importing_motion_loads_neither_networks_nor_audio_analysis() -> None:
    names = [module.name for module in pkgutil.walk_packages(motion.__path__, "motion.")]
    assert {"motion.audio_analysis", "motion.body.model", "motion.formats.bvh"} <= set(names)
    program = (
        f"import sys, {', '.join(names)}\n"
        "print(sorted({'librosa', 'torch', 'numba', 'pandas', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)
    assert done.stdout.decode().strip() == "[]"
