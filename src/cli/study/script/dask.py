"""Runs the study @NAME@ on Dask in @PARTS@ parts, @EACH@ each, and puts them together:

    python @SCRIPT@ [ADDRESS OF THE SCHEDULER]

Without an address it starts workers on this machine. Called again, it goes on with what is there. The folder must be
one that all workers see.
"""

import os
import subprocess
import sys
import time

from dask.distributed import Client

TAUTLINE = os.environ.get("TAUTLINE", @PROGRAM@)
STUDY = @FILE@
OUT = @OUT@
PARTS = @PARTS@
ENOUGH = os.path.join(OUT, "enough")


def part(k):
    """Does one part. A worker that is lost may leave its program running, so whoever tries again waits for that."""
    command = [TAUTLINE, "study", "run", STUDY, "--shard", f"{k}/{PARTS}", "--out", os.path.join(OUT, f"part-{k}")]
    if os.path.exists(ENOUGH):
        return k
    with subprocess.Popen(command + ["--resume", "--wait", "@WAIT@s"], stdout=subprocess.DEVNULL) as program:
        while program.poll() is None:
            time.sleep(0.1)
            if os.path.exists(ENOUGH):
                program.terminate()
        if program.returncode != 0 and not os.path.exists(ENOUGH):
            raise RuntimeError(f"part {k}: exit code {program.returncode}")
    return k


def merge(*options):
    there = [os.path.join(OUT, f"part-{k}") for k in range(PARTS)]
    # What a study has saved, or a sweep of several.
    there = [f for f in there if any(os.path.exists(os.path.join(f, name)) for name in ("state.bin", "sweep.json"))]
    return subprocess.run([TAUTLINE, "study", "merge", *there, *options], stdout=subprocess.DEVNULL)


def is_certain(folder):
    with open(os.path.join(folder, "summary.json")) as summary:
        return '"stopped": "relative_error"' in summary.read()


def main():
    os.makedirs(OUT, exist_ok=True)
    with Client(*sys.argv[1:2]) as client:
        parts = client.map(part, range(PARTS), retries=3, pure=False)
@RULE@        client.gather(parts)
    if os.path.exists(ENOUGH):
        os.remove(ENOUGH)
    merge("--out", os.path.join(OUT, "all")).check_returncode()


if __name__ == "__main__":
    main()
