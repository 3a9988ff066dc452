#!/usr/bin/python3
"""Whatever goes wrong, on all ranks or on one alone, with memory, the terminal, signals or limits: the job ends within seconds, with one
line and the right code.

  one_error.py SCRATCH libpackmpi_mpi_faults.so -- command ...          (command: mpirun -n 2 packmpi)
"""
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

SCENE = """
[container]
size = [0.4, 0.4, 0.1]
[particles]
density = 1000.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
radius = { distribution = "equal", value = 0.02 }
[layers]
thickness = 0.06
fraction = 0.15
duration = 0.02
[jamming]
gravity = 5.0
[dynamics]
time_step = 1.0e-4
[rest]
unbalanced_force = 1e9   # errors are looked for, not rest
kinetic_energy = 1e9
support = 1e9
wait = 0.0
"""
scratch, faults = Path(sys.argv[1]).resolve(), sys.argv[2]
command = sys.argv[sys.argv.index("--") + 1:]
program = command[-1]
failures = []


def check(what, truth, text=""):
    if not truth:
        failures.append(what)
        print(f"not so: {what}\n{text}")


def ours(text):
    """Lines of stderr that are not Open MPI's: it frames its own, or begins them with host and process. A warning of small scenes and few
    cores, before the work, is no error."""
    text = re.sub(r"^-{20,}\n.*?^-{20,}\n", "", text, flags=re.MULTILINE | re.DOTALL)
    return [line for line in text.splitlines() if line.strip() and
            not re.match(r"\[[\w.-]+:\d+\]|Primary job|a non-zero exit|[\d:]{8} W (about \d+ particles|\d+ ranks share)", line)]


def run(words, *, seconds=60, **options):
    environment = {**os.environ, **options.pop("environment", {})}
    done = subprocess.run([str(word) for word in words], env=environment, stdout=options.pop("stdout", subprocess.PIPE),
                          stderr=subprocess.PIPE, text=True, timeout=seconds, cwd=options.pop("cwd", scratch), **options)
    return done.returncode, done.stderr


def ends(what, code, words, arguments, most=20.0, **options):
    """With that code, and one line that has these words; within `most` seconds."""
    begin = time.time()
    try:
        got, text = run(arguments, **options)
    except subprocess.TimeoutExpired:
        check(f"{what}: hangs", False)
        return
    lines = ours(text)
    check(f"{what}: exit code {code}, got {got}", got == code, text)
    check(f"{what}: one line with '{words}'", len(lines) == 1 and re.search(words, lines[0]), text)
    check(f"{what}: took {time.time() - begin:.1f} s", time.time() - begin < most)


def fault(arguments, call, kind="error", rank=1):
    report = scratch / "calls"
    return {"arguments": [*command, *arguments],
            "environment": {"LD_PRELOAD": faults, "MPI_FAULTS_RANK": str(rank), "MPI_FAULTS_CALL": str(call), "MPI_FAULTS_KIND": kind,
                            "MPI_FAULTS_REPORT": str(report)}}


def calls(arguments):
    """How many calls of MPI rank 1 makes."""
    code, text = run(**{"words" if name == "arguments" else name: value for name, value in fault(arguments, 0).items()})
    check(f"{arguments[0]} without a fault, got {code}", code in (0, 3), text)
    return int((scratch / "calls").read_text())


def one_rank_alone():
    """A fault at calls all over a run, and in each command that is collective."""
    whole = calls(["a.toml", "-q", "--force"])
    places = sorted({max(1, round(share * whole)) for share in (0.0, 0.02, 0.05, 0.3, 0.9, 0.97, 0.99, 1.0)} | {8})
    for call in places:
        ends(f"a fault at call {call} of {whole}", 5, "rank 1: a fault for the test", **fault(["a.toml", "-q", "--force"], call))
    calls(["a.toml", "-q", "--force"])
    others = ["analyze", "a.hdf"], ["convert", "a.hdf", "--to", "csv", "--force"], ["estimate", "a.toml", "--no-probe"], ["check", "a.toml"]
    for words in others:
        ends(f"a fault in {words[0]}", 5, "rank 1: a fault for the test", **fault(words, max(1, calls(words) // 2)))
    make = ["a.toml", "-q", "--force"]
    ends("memory of one rank", 4, "rank 1: memory exhausted.*packmpi estimate", **fault(make, whole // 2, "memory"))
    ends("another exception, on rank 0", 4, "rank 0: a fault for the test", **fault(make, whole // 2, "other", rank=0))
    bad = [command[0], "-n", "1", "-x", "PACKMPI_ARCH=z80", program, *make, ":", "-n", "1", program, *make]
    ends("PACKMPI_ARCH of rank 0 alone", 2, "PACKMPI_ARCH=z80 is not known", bad)


def memory():
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (900 << 20, 900 << 20))
    wide = ["--set", "container.size=[100, 100, 0.1]", "--set", "layers.attempts=1000"]
    ends("no memory for a scene", 4, r"memory exhausted: \d+ bytes .* wanted by .*, the scene takes about .* of each rank; use fewer ranks",
         [program, "a.toml", "-q", "-o", "wide", *wide], most=60, preexec_fn=limit)


def terminal():
    shutil.rmtree(scratch / "out", ignore_errors=True)
    make = [program, "a.toml", "-q", "-o", "out", "--force"]
    with open("/dev/full", "w") as full:
        for words in ([program, "schema"], [program, "manual"], [program, "check", "a.toml"], make):
            ends(f"{words[1]} to a full disk", 5, "standard output: No space left", words, stdout=full)
    check("the pack is complete", run([program, "info", "out/a.hdf"])[0] == 0)
    for words in ([program, "schema"], make):
        ends(f"{words[1]} without a stdout", 5, "standard output: Bad file descriptor", ["sh", "-c", 'exec "$@" >&-', "sh", *words])
        end, begin = os.pipe()
        os.close(end)
        ends(f"{words[1]} into a closed pipe", 5, "standard output: Broken pipe", words, stdout=begin)
        os.close(begin)
    check("the pack is complete", run([program, "info", "out/a.hdf"])[0] == 0)
    ends("a working folder that is gone", 5, "working folder cannot be found",
         ["sh", "-c", 'mkdir gone && cd gone && rmdir ../gone && exec "$@"', "sh", program, "--version"])


def limits():
    def small():
        resource.setrlimit(resource.RLIMIT_FSIZE, (8 << 20, 8 << 20))   # less, and MPI does not begin
    shutil.rmtree(scratch / "small", ignore_errors=True)
    wide = ["--set", "container.size=[20, 20, 0.1]"]
    ends("ulimit -f", 5, "File too large", [program, "a.toml", "-q", "-o", "small", *wide], preexec_fn=small)
    check("ulimit -f: no pack is left", not list((scratch / "small").glob("*.hdf*")) if (scratch / "small").exists() else True)


def catches(pid, number):
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    caught = re.search(r"^SigCgt:\s*(\w+)", status, re.MULTILINE)
    return caught is not None and int(caught.group(1), 16) >> (number - 1) & 1


def signals():
    """USR1 and USR2 all the time, from the beginning of main() to the end of the process."""
    for number, words, codes in ((signal.SIGUSR1, ["check", "a.toml"], (0,)), (signal.SIGUSR2, ["check", "a.toml"], (0,)),
                                 (signal.SIGUSR1, ["a.toml", "-q", "-o", "usr1"], (0, 3)),
                                 (signal.SIGUSR2, ["a.toml", "-q", "-o", "usr2"], (75,))):
        process = subprocess.Popen([program, *words], cwd=scratch, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        sent, end = 0, time.time() + 15
        while process.poll() is None and time.time() < end:
            if catches(process.pid, number):
                process.send_signal(number)
                sent += 1
            time.sleep(0.001)
        text = process.communicate()[0]
        what = f"{number.name} to {words[0]} all the time: {codes}, got {process.returncode} after {sent}"
        check(what, process.returncode in codes and sent > 5, text)


def main():
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    (scratch / "a.toml").write_text(SCENE)
    only = os.environ.get("ONLY", "").split()
    for part in (one_rank_alone, memory, terminal, limits, signals):
        if only and part.__name__ not in only:
            continue
        begin = time.time()
        part()
        print(f"{part.__name__}: {time.time() - begin:.1f} s", flush=True)
    print(f"one_error: {'failed: ' + '; '.join(failures) if failures else 'passed'}")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
