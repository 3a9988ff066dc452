#!/usr/bin/env bash
# Every exit code of the program, with the words that go with it, and what is on disk afterwards.
# usage: exit_codes.sh INPUT_FOLDER SCRATCH_FOLDER command ...      (command: mpirun -n N packmpi)
set -u
input=$1
scratch=$2
shift 2
failures=0
rm -rf "$scratch"
mkdir -p "$scratch"
cd "$scratch" || exit 1
# A bed of a few dozen spheres in a second or less, too short for it to come to rest: that is not asked for.
falling=("$input/quickstart.toml" --set 'container.size=[0.3,0.3,0.05]' --set layers.duration=0.02 --set rest.wait=0)
tiny=("${falling[@]}" --set rest.unbalanced_force=1e9 --set rest.kinetic_energy=1e9 --set rest.support=1e9)

# expect CODE WORDS argument ...: the program's exit code, and WORDS (an extended regular expression) in what it prints.
expect() {
  local code=$1 words=$2 text got
  shift 2
  text=$("${command[@]}" "$@" 2>&1)
  got=$?
  if [[ $got -ne $code ]] || ! grep -Eq -- "$words" <<<"$text"; then
    failures=$((failures + 1))
    printf 'exit code %s, expected %s with "%s": %s\n%s\n' "$got" "$code" "$words" "$*" "$text"
  fi
}
must() { "$@" || { failures=$((failures + 1)); echo "not true: $*"; }; }
command=("$@")

expect 0 '^packmpi [0-9]' --version
expect 0 'packmpi SCENE.toml' --help
expect 2 'SCENE is required' run
expect 2 'packmpi report is one process: start it without mpirun' report some.hdf
expect 2 'no-such.toml' no-such.toml
for tool in info analyze 'convert --to csv'; do expect 5 'no-such.hdf' $tool no-such.hdf; done
expect 6 'no-such.hdf' "${tiny[@]}" -o out -q --restart no-such.hdf
must rm -rf out
expect 2 'did you mean "layers.duration"|did you mean "duration"' "${tiny[@]}" --set layers.duratoin=1
expect 2 'use at most [0-9]+ ranks|beyond the limit of eq. \(23\)' "${tiny[@]}" --set dynamics.time_step=1e-3
for time in layers.duration dynamics.relaxation rest.wait; do
  expect 2 "$time: 1e\+300 s are .* steps of .* s, more than 2\^40; give less" "${tiny[@]}" -q --set $time=1e300
done
expect 2 'the name is empty' "${tiny[@]}" -q -o ''
narrow=("${tiny[@]}" --set 'container.size=[0.2,0.2,0.05]' --set output.analysis=true)
expect 2 'output.analysis: its measures reach 2.5 diameters. .*use at most 1 ranks' "${narrow[@]}" -o narrow -q
expect 0 'at most 1 ranks' check "${narrow[@]}"
expect 2 'output.analysis: its measures' estimate "${narrow[@]}" --ranks 2
expect 0 'is valid' check "${tiny[@]}"
must test -z "$(ls -A)"                                    # nothing was written so far

expect 0 'ended by height' "${tiny[@]}" -o out -q
for file in quickstart.hdf quickstart.json quickstart.log quickstart.steps.csv; do must test -s out/$file; done
must test -z "$(find out -name '*.tmp*')"
before=$(md5sum out/*)
expect 2 'quickstart.hdf exists; use --force' "${tiny[@]}" -o out -q
must test "$before" = "$(md5sum out/*)"                    # not a byte was touched
expect 0 'height' "${tiny[@]}" -o out -q --force
before=$(md5sum out/*)
expect 0 'quickstart.hdf is finished, whole, and of this scene' "${tiny[@]}" -o out -q --restart auto
expect 6 'quickstart.hdf is of another scene: seed: 1 before, 2 now' "${tiny[@]}" -o out -q --restart auto --seed 2
must test "$before" = "$(md5sum out/*)"

expect 2 'no particle of out/quickstart.hdf lies wholly in it' convert out/quickstart.hdf --to csv -o none.csv --cut sphere:diameter=1mm
must test ! -e none.csv
# What another run has left there is not named as its own.
touch out/quickstart.analysis.json
expect 0 'beside it .json, .log, .steps.csv$' "${tiny[@]}" -o out -q --force
rm out/quickstart.analysis.json

expect 3 'layers.maximum' "${tiny[@]}" -o short -q --set layers.maximum=1 --set 'container.size=[0.3,0.3,0.4]'
must test -s short/quickstart.hdf                          # a missed target still leaves its pack
expect 3 'missed: rest.kinetic_energy: the mean kinetic energy over m g d is .*, the limit is 0.0001; a layer takes .* s to come down' \
  "${falling[@]}" -o falls -q
must test -s falls/quickstart.hdf
expect 2 'particles.youngs_modulus: 100 Pa is too soft for this bed' "${tiny[@]}" -o soft -q --set particles.youngs_modulus=100
must test ! -e soft
expect 2 'random sequential addition placed' "${tiny[@]}" -o full -q --set layers.fraction=0.38 --set layers.attempts=50
must test ! -e full/quickstart.hdf
# Particles too soft for their impact are pressed through the floor: the run names one and leaves no pack.
expect 4 'layer 1, step [0-9]+, .* s: particle [0-9]+ overlaps .*, beyond 0.5 of it: position .* on rank [01]; it touches .*overlap .*; use dynamics.time_step = .* s or less .*, or particles.youngs_modulus = .* Pa or more' "${tiny[@]}" -o blown -q \
  --set fidelity=paper --set particles.youngs_modulus=1e5 --set 'layers.velocity=[0,0,-10]'
must test ! -e blown/quickstart.hdf

# Without mpirun, Open MPI makes no folder that such programs side by side would share, and take from each other as they end.
mpirun=("${command[@]}")
command=(env TMPDIR="$PWD/session" "${mpirun[-1]}")
expect 0 'is valid' check "${tiny[@]}"
must test ! -e session
# The tools in Python, without mpirun: what is missing is named, with Debian's package.
command=(env PACKMPI_PYTHON=/no/python3 "${mpirun[-1]}")
expect 5 'packmpi plot: cannot start /no/python3: No such file.*apt-get install python3 python3-h5py' plot out/quickstart.hdf
command=(cp "${mpirun[-1]}" alone)
must "${command[@]}"
command=(env LD_LIBRARY_PATH="$(dirname "${mpirun[-1]}")" ./alone)
expect 5 'its Python package is not there' plot out/quickstart.hdf
rm alone
command=("${mpirun[@]}")

expect 5 'Not a directory|not a directory' "${tiny[@]}" -o out/quickstart.json/sub -q
if mkdir disk && mount -t tmpfs -o size=256k tmpfs disk 2>/dev/null; then
  expect 5 'space|room' "${tiny[@]}" -o disk -q --set 'container.size=[1.2,1.2,0.2]'
  must test -z "$(find disk -name '*.hdf*')"
  umount disk
else
  echo "mounting is not allowed here: the full disk was not tried"
fi
[[ $failures -eq 0 ]] && echo "all exit codes as they should be"
exit $((failures > 0))
