#!/usr/bin/python3
"""Runs told to stop or to save themselves while they work, through mpirun: each ends as doc/restart.md says, and goes on to the bits
of a run nobody touched.

  signals.py SCRATCH -- command ...          (command: mpirun -n N packmpi)
"""
import hashlib
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

try:
    import h5py
except ImportError:
    sys.exit(77)   # skipped

SCENE = """
[container]
size = [0.3, 0.3, 0.2]
[particles]
density = 1000.0
youngs_modulus = 1.0e8
poisson_ratio = 0.25
radius = { distribution = "equal", value = 0.02 }
[layers]
thickness = 0.1
fraction = 0.2
duration = 4.0   # stops are looked for once a second: a run of several on a fast machine
[jamming]
gravity = 5.0
[dynamics]
time_step = 1.0e-4
[output]
log_every = 0.01
[checkpoint]
every = "off"
"""
scratch, command = Path(sys.argv[1]), sys.argv[sys.argv.index("--") + 1:]
failures = []


def start(folder, *options, mca=(), quiet=True, **environment):
    words = [command[0], *mca, *command[1:], str(scratch / "signals.toml"), "-o", str(folder), *(["-q"] if quiet else []),
             "--restart", "auto", *options]
    return subprocess.Popen(words, env={**os.environ, **environment}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            start_new_session=True)


def until(condition, what, seconds=30.0):
    end = time.time() + seconds
    while time.time() < end:
        if condition():
            return
        time.sleep(0.01)
    sys.exit(f"signals: waited {seconds} s for {what}")


def is_working(folder):
    """Its time series grows: signals are caught by then, and steps are made."""
    series = folder / "signals.steps.csv"
    until(lambda: series.exists() and series.read_text().count("\n") > 2, f"{folder} to work")


def digest(folder):
    with h5py.File(folder / "signals.hdf") as file:
        return hashlib.sha256(b"".join(file["particles"][name][...].tobytes() for name in sorted(file["particles"]))).hexdigest()


def ranks_of(process):
    """The programs that mpirun started."""
    return [int(word) for word in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]


def check(what, truth, text=""):
    if not truth:
        failures.append(what)
        print(f"not so: {what}\n{text}")


def end(what, process, folder, code, words, whole):
    """Checks how the run ended and that it goes on to the same bits. False if it was over before it was told."""
    text, _ = process.communicate(timeout=60)
    if code != 0 and (folder / "signals.hdf").exists():
        return False
    if code is not None:
        check(f"{what}: exit code {code}, got {process.returncode}", process.returncode == code, text)
    check(f"{what}: says '{words}'", words in text, text)
    if code != 0:
        check(f"{what}: leaves a checkpoint", list(folder.glob("*.ckpt.?.hdf")), text)
        text, _ = (again := start(folder)).communicate(timeout=60)
        check(f"{what}: goes on, got {again.returncode}", again.returncode == 0, text)
    check(f"{what}: the same bits", (folder / "signals.hdf").exists() and digest(folder) == whole)
    return True


def told(what, send, code, words, whole, mca=()):
    """Tells a run that works to stop; anew if it was over before (bounded)."""
    folder = scratch / what.lower().replace(" ", "_")
    for _ in range(5):
        shutil.rmtree(folder, ignore_errors=True)
        process = start(folder, mca=mca)
        is_working(folder)
        send(process, folder)
        if end(what, process, folder, code, words, whole):
            return
    check(f"{what}: told in time, in five tries", False)


def to_mpirun(number):
    return lambda process, folder: process.send_signal(number)


def status(rank, key):
    return next(line.split()[1] for line in Path(f"/proc/{rank}/status").read_text().splitlines() if line.startswith(key))


def term_to_mpirun(process, _folder):
    """mpirun wakes the ranks, sleeps for its patience, then passes TERM on: they stand still until it is there."""
    def stop(ranks):
        for rank in ranks:
            os.kill(rank, signal.SIGSTOP)
        until(lambda: all(status(rank, "State") == "T" for rank in ranks), "the ranks to stand still")

    def has_term(rank):
        return int(status(rank, "ShdPnd"), 16) >> (signal.SIGTERM - 1) & 1

    stop(ranks := ranks_of(process))
    process.send_signal(signal.SIGTERM)
    until(lambda: all(status(rank, "State") != "T" for rank in ranks), "mpirun to wake them")
    stop(ranks)
    until(lambda: all(has_term(rank) for rank in ranks), "TERM")
    for rank in ranks:
        os.kill(rank, signal.SIGCONT)


def to_one_rank(number):
    return lambda process, folder: os.kill(ranks_of(process)[-1], number)


def twice(process, folder):
    victim = ranks_of(process)[-1]
    os.kill(victim, signal.SIGSTOP)   # both are there when it wakes
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGCONT):
        os.kill(victim, number)


def stop_file(process, folder):
    (folder / "STOP").touch()
    process.wait(timeout=60)
    (folder / "STOP").unlink()


def put_stop(_process, folder):
    folder.mkdir(exist_ok=True)
    (folder / "STOP").touch()


def among_samples(what, words, *options, send=None):
    """While samples of a target are filled in there is nothing that a checkpoint could keep."""
    folder = scratch / what.lower().replace(" ", "_")
    process = start(folder, "--set", "target.solid_fraction=0.56", "--set", 'contact.tangential="mindlin"', "--set",
                    "contact.friction=0.5", "--set", "layers.duration=40.0", *options, quiet=False)   # samples of seconds each
    before = ""
    if send is not None:
        for line in process.stdout:
            before += line
            if "tells what friction gives it" in line:
                break
        send(process, folder)
    text = before + process.communicate(timeout=60)[0]
    check(f"{what}: exit code 75, got {process.returncode}", process.returncode == 75, text)
    check(f"{what}: says so", f"stopped while samples for [target] were made, before anything was written: {words}" in text, text)
    check(f"{what}: leaves nothing", not list(folder.glob("*.hdf")), text)


def main():
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    (scratch / "signals.toml").write_text(SCENE)
    process = start(scratch / "untouched")
    text, _ = process.communicate(timeout=120)
    check("the untouched run", process.returncode == 0, text)
    whole = digest(scratch / "untouched")

    process = start(folder := scratch / "usr1")
    is_working(folder)
    process.send_signal(signal.SIGUSR1)
    until(lambda: list(folder.glob("*.ckpt.A.hdf")) or process.poll() is not None, "a checkpoint")
    check("USR1: the run goes on after its checkpoint", process.poll() is None)
    end("USR1", process, folder, 0, "", whole)

    signalled = "a signal said so"
    told("USR2", to_mpirun(signal.SIGUSR2), 75, signalled, whole)
    # mpirun waits all of its patience after TERM, too, and ends with a code of its own
    told("TERM", term_to_mpirun, None, "", whole, mca=("--mca", "odls_base_sigkill_timeout", "3"))
    told("TERM to one rank", to_one_rank(signal.SIGTERM), 75, signalled, whole)
    told("INT to one rank", to_one_rank(signal.SIGINT), 75, signalled, whole)
    told("STOP", stop_file, 75, "the STOP file is there", whole)

    process = start(folder := scratch / "twice")
    is_working(folder)
    twice(process, folder)
    process.communicate(timeout=60)
    check(f"a second one ends it at once, got {process.returncode}", process.returncode not in (0, 75))
    check("a second one: no pack", not (folder / "signals.hdf").exists())

    process = start(folder := scratch / "slurm", SLURM_JOB_END_TIME=str(int(time.time()) + 10))
    end("SLURM_JOB_END_TIME", process, folder, 75, "the time limit is near", whole)

    among_samples("USR2 among samples", "a signal said so", send=to_mpirun(signal.SIGUSR2))
    among_samples("STOP among samples", "the STOP file is there", send=put_stop)
    among_samples("Hours among samples", "the time limit is near", "--max-hours", "1e-6")
    print(f"signals: {'failed: ' + '; '.join(failures) if failures else 'passed'}")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
