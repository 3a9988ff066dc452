#!/usr/bin/python3
"""Kills runs at random moments with SIGKILL, takes their folder away, goes on from what is left, and compares the packs with
that of an untouched run.

  scripts/dev/faults.py [-n KILLS] [--build FOLDER] [--tests] [--document FILE]

Every trial starts `packmpi --restart auto` on 1 to 3 ranks and kills it at a random moment (mpirun and all ranks, one rank, or
mpirun alone), does so once more, and then lets it end; trials go on until there were KILLS kills. A few more have their folder
renamed or removed while they run. Exit code 0: every trial ended with the particle datasets of the untouched run. With --tests the
test programs run that count what they tried. The counts are printed as tables, and written into FILE (doc/reliability.md).
"""
import argparse
import hashlib
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "study"))
from common import ENVIRONMENT, ROOT  # noqa: E402  (of scripts/study)

try:
    import h5py
    import measuring
except ImportError:
    print("faults: needs h5py (scripts/setup.sh --plots)")
    sys.exit(77)   # skipped, for ctest

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
relaxation = 0.2
[checkpoint]
every = "25 steps"
"""
DISTURBANCES_A_TRIAL = 2
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


def kill(process, folder, counts):
    """One rank, mpirun, or mpirun and all ranks; nothing if the run is over."""
    ranks = children(process.pid)
    if process.poll() is not None or not ranks:
        counts["runs over before the kill"] += 1
        return
    what = random.choice(["one rank alone", "mpirun alone", "mpirun and all ranks"])
    victims = {"one rank alone": [random.choice(ranks)], "mpirun alone": [process.pid]}.get(what, [process.pid, *ranks])
    counts[f"kills of {what}"] += 1
    counts["kills"] += 1
    for pid in victims:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.wait()
    for pid in ranks:   # without mpirun nobody waits for them: the next start must find the folder at peace
        for _ in range(6000):
            status = Path(f"/proc/{pid}/stat")
            try:
                if status.read_text().rsplit(")", 1)[1].split()[0] == "Z":
                    break
            except OSError:
                break
            time.sleep(0.01)
        else:
            counts["ranks that did not end"] += 1
            os.kill(pid, signal.SIGKILL)
    counts["of all kills, in the middle of writing a file"] += bool(list(Path(folder).glob("*.tmp")))


def take_away(process, folder, counts):
    """The folder under another name, and back when the run has ended; or removed."""
    if process.poll() is not None or not Path(folder).exists():
        counts["runs over before the kill"] += 1
        return
    elsewhere = Path(f"{folder}.elsewhere")
    removed = random.random() < 0.5
    counts["folders removed in mid-run" if removed else "folders renamed in mid-run"] += 1
    os.rename(folder, elsewhere)
    counts["of them ended with code 5"] += process.wait() == 5
    shutil.rmtree(folder, ignore_errors=True)
    if removed:
        shutil.rmtree(elsewhere)
    else:
        os.rename(elsewhere, folder)


def trial(program, scene, folder, length, disturb, counts):
    """True if the trial ended with a finished run."""
    shutil.rmtree(folder, ignore_errors=True)
    for attempt in range(ATTEMPTS):
        process = start(program, scene, folder, random.randint(1, 3))
        counts["restarts, on 1 to 3 ranks"] += attempt > 0
        if attempt < DISTURBANCES_A_TRIAL:
            time.sleep(random.uniform(0.35, 0.35 + 0.6 * length))
            disturb(process, folder, counts)
        elif process.wait() == 0:
            return True
        if digest(folder) is not None and not list(Path(folder).glob("*.ckpt.*")):
            return True   # killed after its end
    return False


ROWS = ["trials", "kills", "kills of mpirun and all ranks", "kills of one rank alone", "kills of mpirun alone",
        "of all kills, in the middle of writing a file", "folders renamed in mid-run", "folders removed in mid-run",
        "of them ended with code 5", "runs over before the kill", "ranks that did not end", "restarts, on 1 to 3 ranks",
        "survived, the same bits", "lost", "wrong accepted"]


# Programs that print "count: what = n, ..." or "extremes passed: n of m", and the ranks they run on.
COUNTING_TESTS = {"run_restart": (1, 2, 3), "output_checkpoint": (1,), "output_faults": (1, 2), "run_extremes": (1,)}


def count_tests(build):
    """Rows "what | numbers" of the test programs, each line's numbers added over programs and ranks; True if all passed."""
    counts, passed = {}, True
    for name, all_ranks in COUNTING_TESTS.items():
        for ranks in all_ranks:
            done = subprocess.run(["mpirun", "-n", str(ranks), str(next(build.glob(f"tests/*/test_{name}")))], env=ENVIRONMENT,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            passed &= done.returncode == 0
            if done.returncode != 0:
                print(f"{name} failed on {ranks} ranks\n{done.stdout}")
            for line in re.findall(r"^count: (.*)$", done.stdout, re.MULTILINE):
                line = re.sub(r", \d+ ranks:|on up to \d+ ranks", lambda m: ":" if m[0].endswith(":") else "", line)
                row = counts.setdefault(re.sub(r"\d+", "#", line), [])
                row.append([int(n) for n in re.findall(r"= (\d+)", line)])
            for got, asked in re.findall(r"^extremes passed: (\d+) of (\d+)$", done.stdout, re.MULTILINE):
                counts.setdefault("rows of doc/extremes.md tested = #, passed = #", []).append([int(asked), int(got)])
    rows = []
    for line, numbers in counts.items():
        totals = iter(sum(column) for column in zip(*numbers))
        what, *more = re.sub(r"#", lambda _: str(next(totals)), line).split(" = ", 1)
        rows.append(f"| {' '.join(what.split())} | {more[0].replace(' = ', ' ')} |")
    return rows, passed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", type=int, default=200)
    parser.add_argument("--build", default=ROOT / "build")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tests", action="store_true")
    parser.add_argument("--document")
    options = parser.parse_args()
    random.seed(options.seed)
    build = Path(options.build).resolve()
    program = build / "packmpi"
    counts = Counter()
    with tempfile.TemporaryDirectory() as work:
        scene = Path(work) / "faults.toml"
        scene.write_text(SCENE)
        begin = time.time()
        if start(program, scene, Path(work) / "whole", 2).wait() != 0:
            sys.exit("faults: the untouched run failed")
        length = time.time() - begin
        whole = digest(Path(work) / "whole")
        folders = max(1, options.n // 20)   # trials that lose their folder
        while counts["kills"] < options.n or counts["trials"] < folders:
            folder = Path(work) / "run"
            disturb = take_away if counts["trials"] < folders else kill
            counts["trials"] += 1
            ended = trial(program, scene, folder, length, disturb, counts)
            result = ("survived, the same bits" if digest(folder) == whole else "wrong accepted") if ended else "lost"
            counts[result] += 1
            if result != "survived, the same bits":
                print(f"trial {counts['trials']}: {result}")
    table = ["| what | count |", "|---|---|"] + [f"| {row} | {counts[row]} |" for row in ROWS]
    right = counts["survived, the same bits"] == counts["trials"]
    if options.tests:
        rows, passed = count_tests(build)
        table += rows
        right &= passed
    text = f"{measuring.made_by('scripts/dev/faults.sh')}:\n\n" + "\n".join(table)
    print(text)
    if options.document:
        measuring.write_block(options.document, "faults", text)
    sys.exit(0 if right else 1)


if __name__ == "__main__":
    main()
