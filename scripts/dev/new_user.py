#!/usr/bin/python3
"""Plays a new user on a bare Debian 12: the first hour with packmpi, as the pages tell it, and how long each part of it takes.

  scripts/dev/new_user.py [--host-apt] [--with COMMAND ...] [--keep FOLDER] [--document FILE]      as root; debootstrap and unshare

debootstrap puts Debian's smallest system into a folder, from the mirror that apt uses here. In it a plain user with sudo clones the last commit and
runs, as printed: README's blocks from top to bottom, doc/tutorial.md, the notebooks, two how-to pages; then Chromium opens the report of
the first pack. Blocks of hours are left out (LONG), unless one is named by --with. Exit code 1: something failed, and its output is shown.

  --host-apt   takes this machine's settings of apt and its certificates along, where a bare apt reaches no mirror
  --keep       the folder; it stays, and if it holds a bare system already that one is taken
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "study"))
import measuring  # noqa: E402  (of scripts/study)

USER = "newcomer"
LONG = ("scripts/test.sh", "scripts/study/")
HOWTOS = ("howto_powder", "howto_triaxial")
APT = ("/etc/apt", "/etc/ssl/certs", "/usr/local/share/ca-certificates", "/usr/share/ca-certificates", "/usr/share/keyrings")
# The report of README's pack, as a browser has it: all pictures are there, nothing complains, nothing is fetched.
LOOK = """
import sys, tempfile, pathlib
sys.path.insert(0, "tests/system")
import browser
path = pathlib.Path("quickstart.html").resolve()
with tempfile.TemporaryDirectory() as profile, browser.Browser(profile) as page:
    for width in (1400, 390):
        page.look(width)
        page.open(path.as_uri())
        widths = page.value("Promise.all([...document.images].map(one => one.decode().then(() => one.naturalWidth, () => 0)))")
        fetched = [one for one in page.requests if not one.startswith("data:") and one != path.as_uri()]
        complaints = [words for words in page.complaints if "GPU stall" not in words]
        print(width, "pixels:", len(widths), "pictures,", len(fetched), "fetched,", complaints)
        assert len(widths) > 5 and all(widths) and not fetched and not complaints
"""


def mirror():
    """Where apt has Debian 12 from, here."""
    found = subprocess.run(["apt-get", "indextargets", "--format", "$(REPO_URI)", "Created-By: Packages", "Codename: bookworm", "Origin: Debian"],
                           check=True, capture_output=True, text=True).stdout.split()
    return found[0] if found else "http://deb.debian.org/debian"


def blocks_of(page):
    """(language, text) of its blocks of shell and Python, in order."""
    return re.findall(r"^```(sh|py)\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)


def title(block):
    """What a table calls a block: its first command, and how many follow."""
    lines = [line for line in block.splitlines() if line.strip() and not line.startswith(("source", "#"))]
    return f"`{lines[0].split('#')[0].split(' || ')[0].strip()}`" + (f" and {len(lines) - 1} more" if len(lines) > 1 else "")


def steps(wanted):
    """(what, commands) of the first hour, in its order."""
    done = [("`git clone`", "cd ~ && git clone -q /srv/packmpi.git packmpi")]
    for language, block in blocks_of(ROOT / "README.md"):
        if language == "py":
            done.append(("README: the same in Python", f"python3 - <<'PYTHON'\n{block}PYTHON"))
        elif not any(word in block for word in LONG) or block.strip() in wanted:
            done.append((f"README: {title(block)}", block))
    done.append(("`scripts/setup.sh --peers --plots`: LAMMPS", "scripts/setup.sh --peers --plots"))
    done.append(("tutorial.md, with LAMMPS", "python3 tests/system/user_path.py . build/packmpi ~/tutorial"))
    done.append(("`scripts/setup.sh --notebooks`", "scripts/setup.sh --notebooks"))
    done.append(("both notebooks", "source scripts/mpi_env.sh; python3 tests/python/notebooks.py ~/notebooks doc/notebooks/*.ipynb"))
    for page in HOWTOS:
        path = 'export PATH="$PWD/build:$PATH"\n'
        done.append((f"{page}.md, as printed", path + "\n".join(block for _, block in blocks_of(ROOT / "doc" / f"{page}.md"))))
    done.append(("`scripts/setup.sh --report`: Chromium", "scripts/setup.sh --report"))
    done.append(("the report in Chromium, 1400 and 390 pixels wide", f"python3 - <<'PYTHON'{LOOK}PYTHON"))
    return done


def make_bare(root):
    """Debian's smallest system."""
    print(f"debootstrap, from the mirror of apt, into {root}", flush=True)
    subprocess.run(["debootstrap", "--variant=minbase", "bookworm", root, mirror()], check=True, stdout=subprocess.DEVNULL)


def make_user(root, host_apt):
    """One with sudo and git, and the last commit to clone."""
    if host_apt:
        for place in APT:
            if Path(place).is_dir():
                shutil.copytree(place, f"{root}{place}", symlinks=True, dirs_exist_ok=True)
    inside = ["chroot", root, "env", "DEBIAN_FRONTEND=noninteractive", "LC_ALL=C"]
    for command in (["apt-get", "-qq", "update"], ["apt-get", "-qq", "-y", "install", "--no-install-recommends", "sudo", "git", "ca-certificates"],
                    ["useradd", "--create-home", "--shell", "/bin/bash", USER]):
        subprocess.run([*inside, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    Path(root, "etc/sudoers.d", USER).write_text(f"{USER} ALL=(ALL) NOPASSWD: ALL\n")
    subprocess.run(["git", "clone", "-q", "--bare", ROOT, f"{root}/srv/packmpi.git"], check=True)
    subprocess.run(["chroot", root, "chown", "-R", USER, "/srv/packmpi.git"], check=True)


def inside(root, options):
    """All steps, in a mount namespace of their own; a row (what, seconds) for each."""
    for kind, place in (("proc", "proc"), ("sysfs", "sys"), ("devpts", "dev/pts"), ("tmpfs", "dev/shm")):
        Path(root, place).mkdir(exist_ok=True)
        subprocess.run(["mount", "-t", kind, *(["-o", "newinstance,ptmxmode=0666"] if kind == "devpts" else []), kind, f"{root}/{place}"], check=True)
    make_user(root, options.host_apt)
    rows = []
    for what, commands in steps(options.with_):
        Path(root, "tmp/step.sh").write_text(f"set -e\n[[ ! -d ~/packmpi ]] || cd ~/packmpi\n{commands}\n")
        begun = time.monotonic()
        done = subprocess.run(["chroot", root, "su", "-l", USER, "-c", "bash /tmp/step.sh"], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              check=False, stdin=subprocess.DEVNULL)
        rows.append((what, time.monotonic() - begun, done.returncode))
        print(f"{rows[-1][1]:7.1f} s  {what}" + (f": exit code {done.returncode}\n{done.stdout[-4000:]}" if done.returncode else ""), flush=True)
        if done.returncode != 0:   # what follows needs it
            break
    return rows


def table(rows, stamp):
    """For the document."""
    lines = [f"{stamp}, {os.cpu_count()} cores.", "", "| what | time |", "|---|---|"]
    lines += [f"| {what} | {seconds:.0f} s |" for what, seconds, _ in rows]
    return "\n".join([*lines, f"| **all of it** | **{sum(row[1] for row in rows) / 60.0:.0f} min** |"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host-apt", action="store_true", help="this machine's settings of apt and certificates go along")
    parser.add_argument("--with", dest="with_", action="append", default=[], metavar="COMMAND", help="a block of README that takes long, too")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="work there, and leave it")
    parser.add_argument("--document", type=Path, help="write the table into this page")
    parser.add_argument("--inside", metavar="FOLDER", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if os.geteuid() != 0:
        sys.exit("new_user: chroot needs root")
    if options.inside:
        stamp = measuring.made_by("scripts/dev/new_user.py")   # of the commit that is cloned
        rows = inside(options.inside, options)
        failed = any(code for _, _, code in rows)
        if options.document and not failed:
            measuring.write_block(options.document, "new_user", table(rows, stamp))
        return 1 if failed else 0
    place = options.keep.resolve() if options.keep else Path(tempfile.mkdtemp(prefix="packmpi-new-user-"))
    root = str(place / "debian")   # which everybody may enter
    try:
        if not Path(root, "etc/debian_version").exists():
            make_bare(root)
        # What is mounted goes with the process that mounts it: nothing of this machine is in the folder when it is removed.
        return subprocess.run(["unshare", "--mount", "--propagation", "private", sys.executable, *sys.argv, "--inside", root], check=False).returncode
    finally:
        if not options.keep:
            shutil.rmtree(place, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
