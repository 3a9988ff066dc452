#!/usr/bin/python3
"""Nothing a stranger sends, a scene, a curve, a pack, a folder, runs code, writes over what is no output, takes the memory or hangs.

  doors.py SCRATCH -- packmpi
"""
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import time
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit(77)   # skipped

SCENE = """
[container]
size = [0.2, 0.2, 0.06]
boundary = ["periodic", "wall"]
[particles]
density = 1000.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
radius = { distribution = "equal", value = 0.02 }
[layers]
thickness = 0.06
fraction = 0.2
duration = 0.02
[jamming]
gravity = 5.0
[dynamics]
time_step = 1.0e-4
"""
scratch, program = Path(sys.argv[1]).resolve(), sys.argv[sys.argv.index("--") + 1]
failures = []


def check(what, truth, text=""):
    if not truth:
        failures.append(what)
        print(f"not so: {what}\n{text}")


def run(*words, folder=None, seconds=30, limits=None, **environment):
    """Exit code, what was said, and the most memory the process had [B]. A run that hangs is killed, and its code is None."""
    with open(scratch / "said", "w+") as said:
        process = subprocess.Popen([program, *map(str, words)], cwd=folder or scratch, env={**os.environ, **environment}, stdout=said,
                                   stderr=subprocess.STDOUT, preexec_fn=limits)
        end = time.time() + seconds
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid != 0:
                code = os.waitstatus_to_exitcode(status)
                break
            if time.time() > end:
                process.kill()
                os.wait4(process.pid, 0)
                code, usage = None, resource.getrusage(resource.RUSAGE_SELF)
                break
            time.sleep(0.005)
        process.returncode = code
        said.seek(0)
        return code, said.read(), usage.ru_maxrss * 1024


def refuses(what, code, words, *arguments, **options):
    """Ends with that code and one line that has these words."""
    got, text, memory = run(*arguments, **options)
    check(f"{what}: exit code {code}, got {got}", got == code, text)
    check(f"{what}: one line with '{words}'", text.count("\n") == 1 and re.search(words, text), text)
    return memory


def fresh(name):
    folder = scratch / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "a.toml").write_text(SCENE)
    return folder


# Packs with another contents, sealed as packmpi would (file_format.md, "Seal"): all of it frame, no rows.
def fnv(data, value=0xcbf29ce484222325):
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 & 0xffffffffffffffff
    return value


def forge(pack, path, change):
    data = pack.read_bytes()
    end = struct.unpack("<q", data[-40:-32])[0]
    path.write_bytes(data[:end])
    with h5py.File(path, "r+") as file:
        change(file)
    data = path.read_bytes()
    words = struct.pack("<qqQ", 0, len(data), fnv(data))
    path.write_bytes(data + words + struct.pack("<Q", fnv(words)) + b"packmpi-seal-v1\n")


def put(name, row, value):
    def change(file):
        file[name][row] = value
    return change


def attribute(group, name, value):
    def change(file):
        del file[group].attrs[name]
        file[group].attrs[name] = value
    return change


def replace(name, **how):
    def change(file):
        del file[name]
        file.create_dataset(name, **how)
    return change


def late(name, rows):
    """A dataset in one piece that was never written: it has no place in the file."""
    def change(file):
        del file[name]
        made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        made.set_alloc_time(h5py.h5d.ALLOC_TIME_LATE)
        h5py.h5d.create(file.id, name.encode(), h5py.h5t.NATIVE_INT64, h5py.h5s.create_simple((rows,)), made)
    return change


def outside(file):
    del file["particles/id"]
    file["particles/id"] = h5py.ExternalLink("a.hdf", "/particles/id")


def virtual(file):
    count = len(file["particles/id"])
    layout = h5py.VirtualLayout(shape=(count,), dtype="i8")
    layout[:] = h5py.VirtualSource("a.hdf", "particles/id", shape=(count,))
    del file["particles/id"]
    file.create_virtual_dataset("particles/id", layout)


def stored_outside(file):
    count = len(file["particles/id"])
    del file["particles/id"]
    file.create_dataset("particles/id", (count,), dtype="i8", external=[("/etc/passwd", 0, 8 * count)])


def hostile_packs():
    folder = fresh("packs")
    code, text, _ = run("a.toml", "-q", folder=folder)
    check("a pack is made", code in (0, 3), text)
    pack = folder / "a.hdf"
    evil = folder / "evil.hdf"
    forge(pack, evil, lambda file: None)
    code, text, _ = run("info", evil)
    check("a pack that is sealed anew is read", code == 0, text)
    numbers = {"a NaN": put("particles/position", (1, 0), np.nan), "1e300 m": put("particles/position", (1, 2), 1e300),
               "an infinite radius": put("particles/radius", 1, np.inf), "a radius below 0": put("particles/radius", 1, -1.0),
               "a wide radius": put("particles/radius", 1, 1e3), "an endless speed": put("particles/velocity", (1, 1), np.inf),
               "equal ids": put("particles/id", 1, 0), "a layer below 0": put("particles/layer", 1, -5),
               "dimension 7": attribute("summary", "dimension", np.int64(7)), "2D": attribute("summary", "dimension", np.int64(2))}
    for what, change in numbers.items():
        forge(pack, evil, change)
        refuses(f"analyze, {what}", 5, "evil.hdf", "analyze", evil)
    refuses("convert, dimension 2", 5, "evil.hdf", "convert", evil, "--to", "csv")
    many = 20_000_000
    shapes = {"never written chunks": replace("particles/id", shape=(many,), dtype="i8", chunks=(1000,)),
              "never written": late("particles/id", many), "an external link": outside, "a virtual dataset": virtual,
              "external storage": stored_outside, "compressed": replace("particles/radius", data=np.full(1000, 0.02), compression="gzip"),
              "other numbers": replace("particles/radius", data=np.full(3, 0.02, dtype="f4")),
              "a list of versions": attribute("provenance", "version", np.array(["a", "b"], dtype=h5py.string_dtype()))}
    for what, change in shapes.items():
        forge(pack, evil, change)
        tool = ("convert", evil, "--to", "csv", "--force") if what.startswith("a list") else ("info", evil)
        memory = refuses(what, 5, "evil.hdf|no single value", *tool)
        check(f"{what}: {memory * 1e-6:.0f} MB", memory < 200e6)


def generated_scripts():
    """A version and a name that would be commands stay words."""
    folder = fresh("scripts")
    run("a.toml", "-q", folder=folder)
    words = 'x\nimport os; os.system("touch owned")\nshell touch owned\n#include "owned"\n\\'
    pack = folder / "b\nprint('owned')\nshell touch owned.hdf"
    forge(folder / "a.hdf", pack, attribute("provenance", "version", words))
    for form in ("lammps", "liggghts", "yade", "esys", "mercurydpm", "lethe", "pfc", "xyz", "csv", "vtk"):
        code, text, _ = run("convert", pack, "--to", form, "-o", f"{form}.out", folder=folder)
        check(f"{form}: converted", code == 0, text)
        for path in folder.glob(f"{form}.*"):
            lines = path.read_bytes().decode(errors="replace").split("\n")
            begun = [line for line in lines if re.match(r"\s*(import os;|shell touch|print\(.owned|#include .owned)", line)]
            check(f"{form}: no command in {path.name}", not begun, begun)
    refuses("a name with a line end", 2, "control characters", "convert", "a.hdf", "--to", "csv", "-o", "x\ny.csv", folder=folder)
    code, _, _ = run("convert", "a.hdf", "--to", "yade", "-o", "q'\"\\ é.txt", folder=folder)
    script = (folder / "q'\"\\ é.py").read_text()
    text = re.search(r"os.environ.get\('PACK_DATA', (.*)\)\n", script).group(1)
    check("YADE: any name is a string of Python", code == 0 and eval(text) == "q'\"\\ é.txt", script)   # of our own making
    refuses("LAMMPS: a quote in a name", 2, "LAMMPS", "convert", "a.hdf", "--to", "lammps", "-o", "a'b.data", folder=folder)
    refuses("Lethe: a comma in a name", 2, "Lethe", "convert", "a.hdf", "--to", "lethe", "-o", "a,b.txt", folder=folder)


def names_with_blanks():
    folder = fresh("blanks")
    for form, tool, name in (("lammps", "lmp", "a pack #1"), ("liggghts", "liggghts", "ein großer pack #1")):
        (folder / f"{name}.toml").write_text(SCENE)
        code, text, _ = run(f"{name}.toml", "-q", folder=folder)
        check(f"{name}: made", code in (0, 3), text)
        code, text, _ = run("convert", f"{name}.hdf", "--to", form, folder=folder)
        check(f"{form}: converted", code == 0, text)
        if shutil.which(tool):
            done = subprocess.run([tool, "-in", f"{name}.{form}.in"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            check(f"{tool} runs it", done.returncode == 0 and done.stdout.count(b"PACK ") >= 2, done.stdout.decode(errors="replace"))
    refuses("LAMMPS: letters beyond ASCII", 2, "-o FILE", "convert", "ein großer pack #1.hdf", "--to", "lammps", folder=folder)


def petsc():
    folder = fresh("petsc")
    (folder / ".petscrc").write_text("-dll_append /no/such/library\n-log_view :owned\n")
    code, text, _ = run("check", "a.toml", folder=folder, HOME=str(folder), PETSC_OPTIONS="-options_file /no/such/file",
                        PETSC_OPTIONS_YAML="{")
    check(f".petscrc and PETSC_OPTIONS are not read, got {code}", code == 0 and not (folder / "owned").exists(), text)
    (folder / "mine").write_text("kept")
    for words in ("-log_view :mine", "-implicit_snes_view :mine", "-implicit_ksp_view_mat binary:mine", "-malloc_dump mine", "-info :mine",
                  "-dll_append mine", "-options_file mine", "-implicit_pc_type python", "-implicit_ksp_monitor_lg_residualnorm"):
        refuses(words, 2, "petsc.options", "check", "a.toml", "--set", f"petsc.options={words}", folder=folder)
    check("a file is kept", (folder / "mine").read_text() == "kept")
    for words in ("-log_view", "-implicit_snes_rtol 1e-9 -implicit_ksp_type cg", "-sf_type basic"):
        code, text, _ = run("check", "a.toml", "--set", f"petsc.options={words}", folder=folder)
        check(f"{words} is taken", code == 0, text)


def temporary_names():
    folder = fresh("links")
    (folder / "mine").write_text("kept")
    names = ("a.hdf.tmp", "a.json.tmp", "a.ckpt.A.hdf.tmp", "a.steps.csv.tmp")
    for name in names:
        (folder / name).symlink_to("mine")
    (folder / "a.steps.csv").symlink_to("new")
    (folder / "a.log").symlink_to("newer")
    code, text, _ = run("a.toml", "-q", folder=folder)
    check(f"links under temporary names, got {code}", code in (0, 3), text)
    check("what links lead to is kept", (folder / "mine").read_text() == "kept")
    check("nothing is made through links", not (folder / "new").exists() and not (folder / "newer").exists())
    outputs = [path for path in folder.glob("a.*") if path.suffix != ".tmp"]
    check("no output is a link", not any(path.is_symlink() for path in outputs), outputs)


def pipes_and_devices():
    folder = fresh("pipes")
    os.mkfifo(folder / "pipe")
    kind = "a FIFO, not a regular file"
    refuses("scene", 2, kind, "check", "pipe", folder=folder)
    refuses("a device as scene", 2, "a device, not a regular file", "check", "/dev/zero", folder=folder)
    curve = 'particles.radius={distribution="grading", diameter_curve_file="pipe", weighting="mass"}'
    refuses("curve", 2, kind, "check", "a.toml", "--set", curve, folder=folder)
    refuses("info", 5, kind, "info", "pipe", folder=folder)
    refuses("analyze", 5, kind, "analyze", "pipe", folder=folder)
    refuses("convert", 5, kind, "convert", "pipe", "--to", "csv", folder=folder)
    refuses("restart", 6, kind, "a.toml", "-q", "--restart", "pipe", "-o", "new", folder=folder)
    for name in ("a.hdf.tmp", "a.json.tmp", "a.log", "a.steps.csv", "a.ckpt.A.hdf"):
        os.mkfifo(folder / name)
        code, text, _ = run("a.toml", "-q", *(("--restart", "auto") if "hdf" in name else ("--force",)), folder=folder)
        check(f"{name} is a FIFO: ends, got {code}", code is not None and code >= 0, text)
        for path in folder.iterdir():
            if path.is_dir():
                shutil.rmtree(path)
            elif path.name not in ("a.toml", "pipe"):
                path.unlink()


def curves():
    folder = fresh("curves")
    (folder / "secret").write_text("root:secret words\n")
    here = "the scene's folder"
    for name, words in (("/etc/passwd", here), ("../curves/secret", here), ("secret", "is no grading curve")):
        radius = f'particles.radius={{distribution="grading", diameter_curve_file="{name}", weighting="mass"}}'
        refuses(f"curve {name}", 2, words, "check", "a.toml", "--set", radius, folder=folder)
        _, text, _ = run("check", "a.toml", "--set", radius, folder=folder)
        check(f"curve {name}: its words are not told", "root:" not in text, text)


def starts():
    """What a run would refuse, a check refuses, too."""
    folder = fresh("starts")
    for text, words in (("x,y,z,r,d\n1,1,1,1,2\n", "two columns of radii"), ("x,y,z,r\n", "no particle in it"), ("x,y,z,r\n1,nan,1,1\n", "column y has no number")):
        (folder / "s.csv").write_text(text)
        refuses(f"start: {words}", 2, words, "check", "a.toml", "--set", "start.pack=s.csv", folder=folder)


def main():
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    only = os.environ.get("ONLY", "").split()
    for part in (hostile_packs, generated_scripts, names_with_blanks, petsc, temporary_names, pipes_and_devices, curves, starts):
        if only and part.__name__ not in only:
            continue
        begin = time.time()
        part()
        print(f"{part.__name__}: {time.time() - begin:.1f} s", flush=True)
    print(f"doors: {'failed: ' + '; '.join(failures) if failures else 'passed'}")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
