# SPDX-License-Identifier: Apache-2.0
"""python3 -m tauext [ROBOT] prints the version, the robots, and what runs on one of them (wallmobot3 unless named)."""
import signal
import sys

import tauext
from tauext import _core


def main() -> int:
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # whoever reads may stop
    if len(sys.argv) > 2 or sys.argv[1:2] in (["-h"], ["--help"]):
        print(__doc__)
        return 0 if len(sys.argv) == 2 else 2
    try:
        robot = tauext.Robot(*(sys.argv[1:] or ["wallmobot3"]))
    except (RuntimeError, ValueError) as e:
        print(f"python3 -m tauext: {e}", file=sys.stderr)
        return 2
    print(f"{_core.build()}, MuJoCo {_core.mujoco_version()}")
    print(f"robots: {', '.join(tauext.robots())}; and any MJCF or URDF file")
    print(f"estimators: {', '.join(robot.estimators())}")
    print(f"detectors: {', '.join(robot.detectors())}")
    print(f"scenarios of {robot.name}:")
    for name, text in robot.scenarios().items():
        print(f"  {name:<12} {text}")
    return 0


sys.exit(main())
