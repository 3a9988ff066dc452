#!/usr/bin/python3
"""Kills runs at random moments with SIGKILL, goes on from what is left, and compares the packs with that of an untouched run.

  scripts/faults.py [-n TRIALS] [--build FOLDER] [--doc doc/reliability.md]

Every trial starts `packmpi --restart auto` on 1 to 3 ranks, kills it after a random part of an untouched run's time (mpirun
and all ranks, or one rank alone), does so once more, and then lets it end. Exit code 0: every trial ended with the
particle datasets of the untouched run. With --doc the counts replace the part between the page's "faults" markers.
"""
import argparse
import datetime
import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

try:
    import h5py
except ImportError:
    print("faults: needs h5py (scripts/setup.sh --plots)")
    sys.exit(77)   # skipped, for ctest

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_hwloc_base_binding_policy="none",
                   OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_btl_vader_single_copy_mechanism="none")
SCENE = """
[container]
size = [0.4, 0.4, 0.25]
[particles]
density = 1000.0
youngs_modulus = 1.0e8
poisson_ratio = 0.25
radius = { distribution = "uniform", min = 0.014, max = 0.02, weighting = "number" }
[layers]
thickness = 0.1
fraction = 0.22
duration = 0.3
[jamming]
gravity = 5.0
[dynamics]
time_step = 1.0e-4
window = 2
thaw = 0.2
[checkpoint]
every = "100 steps"
"""
BEGIN, END = "<!-- faults: begin -->", "<!-- faults: end -->"
KILLS_A_TRIAL = 2
ATTEMPTS = 12   # starts a trial may take


def start(program, scene, folder, ranks):
    return subprocess.Popen(["mpirun", "-n", str(ranks), program, scene, "-o", folder, "-q", "--restart", "auto"], env=ENVIRONMENT,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def digest(folder):
    """Of all particle datasets of the folder's pack; None if there is none."""
    path = Path(folder) / "faults.hdf"
    if not path.exists():
        return None
    with h5py.File(path) as file:
        total = hashlib.sha256()
        for name in sorted(file["particles"]):
            total.update(file["particles"][name][...].tobytes())
    return total.hexdigest()


def children(pid):
    out = subprocess.run(["pgrep", "-P", str(pid)], text=True, stdout=subprocess.PIPE, check=False).stdout
    return [int(word) for word in out.split()]


def kill(process, counts):
    """One rank, or mpirun and all ranks; nothing if the run is over."""
    ranks = children(process.pid)
    if process.poll() is not None or not ranks:
        counts["runs over before the kill"] += 1
        return
    victims = [random.choice(ranks)] if random.random() < 0.5 else [process.pid, *ranks]
    counts["kills of one rank alone" if len(victims) == 1 else "kills of mpirun and all ranks"] += 1
    for pid in victims:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.wait()
    for pid in ranks:   # without mpirun nobody waits for them: the next start must find the folder at peace
        while Path(f"/proc/{pid}").exists() and "Z" not in Path(f"/proc/{pid}/stat").read_text().split(")")[1][:3]:
            time.sleep(0.01)


def trial(program, scene, folder, length, counts):
    """True if the trial ended with a finished run."""
    shutil.rmtree(folder, ignore_errors=True)
    for attempt in range(ATTEMPTS):
        process = start(program, scene, folder, random.randint(1, 3))
        counts["restarts, on 1 to 3 ranks"] += attempt > 0
        if attempt < KILLS_A_TRIAL:
            time.sleep(random.uniform(0.2, length))
            kill(process, counts)
        elif process.wait() == 0:
            return True
        if digest(folder) is not None and not list(Path(folder).glob("*.ckpt.*")):
            return True   # killed after its end
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", type=int, default=200)
    parser.add_argument("--build", default=ROOT / "build")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--doc")
    options = parser.parse_args()
    random.seed(options.seed)
    program = Path(options.build).resolve() / "packmpi"
    counts = Counter()
    with tempfile.TemporaryDirectory() as work:
        scene = Path(work) / "faults.toml"
        scene.write_text(SCENE)
        begin = time.time()
        if start(program, scene, Path(work) / "whole", 2).wait() != 0:
            sys.exit("faults: the untouched run failed")
        length = time.time() - begin
        whole = digest(Path(work) / "whole")
        for number in range(1, options.n + 1):
            folder = Path(work) / "run"
            ended = trial(program, scene, folder, length, counts)
            result = ("survived, the same bits" if digest(folder) == whole else "wrong accepted") if ended else "lost"
            counts[result] += 1
            if result != "survived, the same bits":
                print(f"trial {number}: {result}")
    rows = ["kills of mpirun and all ranks", "kills of one rank alone", "runs over before the kill", "restarts, on 1 to 3 ranks",
            "survived, the same bits", "lost", "wrong accepted"]
    table = "\n".join(["| what | count |", "|---|---|", f"| trials | {options.n} |"] + [f"| {row} | {counts[row]} |" for row in rows])
    print(table)
    if options.doc:
        commit = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], text=True, capture_output=True, check=False).stdout.strip()
        head, rest = Path(options.doc).read_text().split(BEGIN)
        text = f"`scripts/faults.py -n {options.n}`, {datetime.date.today()}, commit {commit}:\n\n{table}"
        Path(options.doc).write_text(f"{head}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")
    sys.exit(0 if counts["survived, the same bits"] == options.n else 1)


if __name__ == "__main__":
    main()
