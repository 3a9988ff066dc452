#!/usr/bin/python3
"""Exactly solvable problems against the time step, and the step that the law can bear: tables in doc/accuracy.md.

usage: scripts/study/exact_problems.py

Runs build/tests/bench/exact_bench (scripts/build.sh exact_bench): some seconds, with the guard study a few minutes.
"""
import subprocess

import measuring


def output(*words):
    return subprocess.run([measuring.ROOT / "build/tests/bench/exact_bench", *words], env=measuring.ENVIRONMENT, capture_output=True,
                          text=True, check=True).stdout.rstrip()


def main():
    text = [f"{measuring.made_by('scripts/study/exact_problems.py')}. Relative errors of the explicit scheme. Steps are shares of T, the duration of the "
            "contact by eq. (23); T/5 is what `time_step = \"auto\"` takes. Errors of impacts are root mean squares over eight phases of the first "
            "touch within a step. Order: between T/40 and T/160.", "", output(), "",
            "**What the law can bear.** A loose layer of spheres falls and comes to rest within two falls. Valid: no guard speaks, and the energy "
            "never rises by a hundredth of what was given.", "", output("guard")]
    print("\n".join(text))
    measuring.write_block(measuring.ROOT / "doc/accuracy.md", "exact", "\n".join(text))


if __name__ == "__main__":
    main()
