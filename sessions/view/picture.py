#!/usr/bin/env python3
"""Picture of a file for the Rerun viewer, made without a window.

    python -m venv venv && venv/bin/pip install rerun-sdk==0.36.3
    venv/bin/python sessions/view/picture.py FILE.rrd FILE.png [--view NAME] [--rerun venv/bin/rerun]

The picture needs Vulkan: of a graphics card, or Mesa's in software. In Debian: `apt-get install mesa-vulkan-drivers
libvulkan1`. With several drivers, VK_ICD_FILENAMES=/usr/share/vulkan/icd.d/lvp_icd.x86_64.json selects Mesa's.
The slider is at the end of the file, so a file of `sulcus-sessions review --to S` shows the time S.

--view: `all` (default), or the number of a view in the layout. Views and containers are numbered in the order of the tree.
In reviews of this version 3 is the mouth, 5 the pocket, 6 the tongue.
"""

import argparse
import os
import sys
import tempfile
import time


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file")
    parser.add_argument("picture")
    parser.add_argument("--view", default="all")
    parser.add_argument("--rerun", help="program of the viewer; default: rerun on PATH")
    parser.add_argument("--port", type=int, default=9899)
    parser.add_argument("--wait", type=float, default=6.0, help="seconds for the viewer to draw, default 6")
    asked = parser.parse_args()
    # The viewer has another working directory.
    asked.picture = os.path.abspath(asked.picture)

    if "XDG_RUNTIME_DIR" not in os.environ:
        os.environ["XDG_RUNTIME_DIR"] = tempfile.mkdtemp()
    import rerun as rr
    import rerun.experimental as experimental

    if os.path.exists(asked.picture):
        os.remove(asked.picture)
    viewer = experimental.ViewerClient.spawn(
        headless=True, port=asked.port, hide_welcome_screen=True, executable_path=asked.rerun
    )
    try:
        stream = rr.RecordingStream("sulcus_picture")
        stream.connect_grpc(f"rerun+http://127.0.0.1:{asked.port}/proxy")
        stream.log_file_from_path(asked.file)
        stream.flush()
        time.sleep(asked.wait)
        if asked.view == "all":
            viewer.save_screenshot(asked.picture)
        else:
            number = int(asked.view)
            viewer.save_screenshot(asked.picture, view_id=f"00000000-0000-4000-8000-{number:012x}")
        # The viewer writes the picture a little later.
        for _ in range(100):
            if os.path.exists(asked.picture) and os.path.getsize(asked.picture) > 0:
                time.sleep(1.0)
                return 0
            time.sleep(0.2)
    finally:
        viewer.close()
    print(f"{asked.file}: no picture after 20 s, expected one", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
