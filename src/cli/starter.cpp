#include "cli/starter.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "input/fidelity.hpp"
#include "input/keys.hpp"
#include "input/read.hpp"
#include "input/values.hpp"

namespace packmpi::cli {

using namespace input;

namespace {

constexpr std::size_t width = 100;  // columns of a comment

// What has no default must come from somewhere: the material and the layers of the paper's examples, in a small box.
std::string example(int dimension) {
  return fmt::format(
      "fidelity = \"balanced\"\ncontainer.dimension = {}\ncontainer.size = {}\n"
      "particles.density = 1000.0\nparticles.youngs_modulus = 1.0e8\nparticles.poisson_ratio = 0.25\n"
      "particles.radius.distribution = \"equal\"\nparticles.radius.value = {}\n"
      "layers.thickness = 0.1\nlayers.fraction = {}\njamming.gravity = 2.0\n",
      dimension, dimension == 3 ? "[0.4, 0.4, 0.3]" : "[0.6, 0.3]", dimension == 3 ? "0.02" : "0.01",
      dimension == 3 ? "0.25" : "0.4");
}

std::string comment(std::string_view text) {
  std::string out, line = "#";
  while (!text.empty()) {
    const std::size_t space = text.find(' ');
    const std::string_view word = text.substr(0, space);
    if (line.size() > 1 && line.size() + 1 + word.size() > width) {
      out += line + "\n";
      line.resize(1);
    }
    line += fmt::format(" {}", word);
    text.remove_prefix(space == std::string_view::npos ? text.size() : space + 1);
  }
  return out + line + "\n";
}

bool at_default(const Key& key, Input& in) {
  if (!key.standard) return false;
  Input other = in;
  store_default(key, other);
  return written(key, other) == written(key, in);
}

bool by_preset(const Key& key, const Input& in) {
  return std::ranges::any_of(preset(in), [&](const PresetValue& entry) { return entry.path == key.path; });
}

std::string lines(const Key& key, Input& in) {
  const std::string_view name = split_path(key.path).second;
  std::string text = comment(fmt::format("{} ({})", key.doc, wanted(key)));
  if (!key.applies(in)) return text + fmt::format("# {} = ...   # only if {}\n", name, key.when.words);
  if (by_preset(key, in)) return text + fmt::format("# {} = {}   # by fidelity\n", name, written(key, in));
  return text + fmt::format("{}{} = {}\n", at_default(key, in) ? "# " : "", name, written(key, in));
}

}  // namespace

std::string starter(int dimension) {
  Input in = parse(example(dimension), "example", {});
  std::string text =
      "# A scene of packmpi. Numbers are in SI units, or text with a unit: \"20 mm\". Keys that are commented out\n"
      "# have the value shown as long as the file is as packmpi init wrote it: some follow from others (\"by\n"
      "# fidelity\"). After a change, packmpi check FILE prints all of them. Run it with: mpirun -n 2 packmpi FILE\n\n";
  std::string_view open;
  for (const Key& key : keys()) {
    const std::string_view table = split_path(key.path).first;
    if (table != open) {  // a table that is there only if it is named stays away
      const bool absent = (!in.near_field && table == "near_field") || (!in.start && table == "start") ||
                          (!in.target && table == "target") || (!in.confinement && table == "confinement");
      text += fmt::format("\n{}[{}]\n", absent ? "# " : "", table);
    }
    open = table;
    text += lines(key, in);
  }
  return text;
}

}  // namespace packmpi::cli
