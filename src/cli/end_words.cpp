// What the help text and the manual say of signals and exit codes.
#include "cli/options.hpp"

namespace packmpi::cli {

const std::vector<EndWords>& example_words() {
  static const std::vector<EndWords> lines{
      {"packmpi init bed.toml", "a scene to begin with: every key, with its meaning"},
      {"packmpi estimate bed.toml", "particles, memory and time, before it is run"},
      {"mpirun -n 4 packmpi bed.toml -o out", "the pack, on four ranks: out/bed.hdf"},
      {"packmpi bed.toml --set contact.friction=0.1", "the same with another friction"},
      {"packmpi bed.toml -o out --restart auto", "go on from the newest checkpoint"},
      {"packmpi report out/bed.hdf", "one page on it, out/bed.html"},
      {"packmpi convert out/bed.hdf --to lammps", "for another code"}};
  return lines;
}

const std::vector<EndWords>& signal_words() {
  static const std::vector<EndWords> lines{{"USR1", "write a checkpoint and go on"},
                                           {"USR2, TERM, INT", "write a checkpoint and end with code 75"},
                                           {"a second TERM or INT", "end at once"},
                                           {"a file STOP in the folder", "the same as USR2"}};
  return lines;
}

const std::vector<EndWords>& exit_code_words() {
  static const std::vector<EndWords> lines{{"0", "done, and the targets are met"},
                                           {"2", "bad usage, or a scene that is wrong or not there"},
                                           {"3", "finished, but a target was missed"},
                                           {"4", "numerical failure"},
                                           {"5", "another file is not there, damaged, or cannot be written"},
                                           {"6", "--restart has nothing to go on from: damaged, or of another scene"},
                                           {"75", "stopped early with a checkpoint: --restart auto goes on"}};
  return lines;
}

}  // namespace packmpi::cli
