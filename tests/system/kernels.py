#!/usr/bin/python3
"""Is the law of every step kernel computed in vectors, for each instruction set, and does none of them call another function?

usage: kernels.py LIBRARY

A compiler that cannot vectorise one of the loops says nothing, and the kernel takes twice the time. So the machine code is read: whatever a
contact is, it takes roots, and those of the pairs and of the walls are in vectors; scalar ones are left for the rest of a loop. What a kernel
calls could be of another instruction set, and blocks are too short for memcpy.
"""
import re
import subprocess
import sys
from collections import Counter

KERNELS = 34   # of each instruction set and dimension: kernel_count of dynamics/kernel_impl.cpp


def kernels(library):
    """Name of each kernel -> its instructions, as text."""
    text = subprocess.run(["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", library], check=True, capture_output=True, text=True).stdout
    found = {}
    for name, body in re.findall(r"^[0-9a-f]+ <([^\n]+)>:\n((?:.+\n)+)", text, re.MULTILINE):
        if "::step<" in name and "StepData" in name:
            found[re.search(r"(x86_64\w*)_([23])d::step<.*?(\{.*?\})>", name).groups()] = body
    return found


def roots(features):
    """How many roots the law's loops over pairs and over walls take, one after the other."""
    dimension, _, friction, _, _, _, _, _, rolling = features.strip("{}").split(", ")[:9]
    of_each = 2 + (dimension == "3" and friction == "true") + (dimension == "3" and rolling == "true")   # the contact's and of slips
    return 2 * of_each + 1   # the distance of the centres


def faults(kernel, body):
    wanted, there = roots(kernel[2]), len(re.findall(r"\sv?sqrtpd\s", body))
    if there < wanted:
        yield f"{there} roots in vectors, not {wanted}: a loop of the law is not vectorised"
    for called in re.findall(r"\scall\s+(.*)", body):
        yield f"calls {called}"


def main():
    found = kernels(sys.argv[1])
    builds = Counter(kernel[:2] for kernel in found)
    wrong = [f"{' '.join(kernel)}: {fault}" for kernel, body in found.items() for fault in faults(kernel, body)]
    wrong += [f"{count} kernels of {build}, not {KERNELS}" for build, count in builds.items() if count != KERNELS]
    print("\n".join(wrong))
    print(f"{len(found)} kernels of {len(builds)} builds, {len(wrong)} faults")
    sys.exit(1 if wrong or not found else 0)


if __name__ == "__main__":
    main()
