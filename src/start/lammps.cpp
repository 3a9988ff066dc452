// LAMMPS data files of atom_style sphere.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <unordered_map>

#include "start/text_file.hpp"
#include "start/text_rows.hpp"

namespace packmpi::start {
namespace {

using Words = std::vector<std::string_view>;

Words words_of(std::string_view line) { return cells_of(line.substr(0, line.find('#')), ' '); }

double number_of(const TextFile& file, const Words& words, std::size_t k) {
  double value = 0.0;
  if (k >= words.size() || !is_number(words[k], false, value))
    file.refuse(fmt::format("word {} is to be a number, and is none", k + 1));
  return value;
}

// "Atoms # sphere": a section begins.
bool is_section(std::string_view line) { return !line.empty() && std::isupper(static_cast<unsigned char>(line[0])); }

class Reader {
 public:
  Reader(const std::string& path, int dimension, Rank rank, int ranks)
      : file_(path), dimension_(dimension), rank_(rank), ranks_(ranks) {
    found_.box.emplace();
  }

  TextRows read() {
    std::string line;
    (void)file_.next(line);  // a title
    bool head = true;
    while (file_.next(line)) {
      const Words words = words_of(line);
      if (words.empty()) continue;
      if (is_section(line)) {
        begin_section(line, words);
        head = false;
      } else if (head) {
        take_head(words);
      } else if (section_ == Section::atoms) {
        take_atom(words);
      } else if (section_ == Section::velocities) {
        take_velocity(words);
      }
    }
    if (found_.total == 0 || static_cast<double>(found_.total) != atoms_)
      file_.refuse(fmt::format("has {} atoms of the {} in its head", found_.total, atoms_));
    found_.taken = velocities_ ? "positions, radii, velocities, spins" : "positions, radii";
    found_.left = "atom ids, types, densities";
    return std::move(found_);
  }

 private:
  enum class Section { other, atoms, velocities };

  void take_head(const Words& words) {
    constexpr std::array<std::string_view, 3> lows{"xlo", "ylo", "zlo"};
    if (words.size() >= 2 && words[1] == "atoms") atoms_ = number_of(file_, words, 0);
    if (words.size() < 4) return;
    const auto axis = std::ranges::find(lows, words[2]);
    if (axis != lows.end())
      (*found_.box)[static_cast<std::size_t>(axis - lows.begin())] = {number_of(file_, words, 0),
                                                                      number_of(file_, words, 1)};
    const bool tilted = words.size() >= 6 && words[3] == "xy";
    for (std::size_t k = 0; tilted && k < 3; ++k) {
      if (number_of(file_, words, k) != 0.0) file_.refuse("the box is tilted; a container is upright");
    }
  }

  void begin_section(std::string_view line, const Words& words) {
    const bool atoms = words[0] == "Atoms";
    section_ = atoms ? Section::atoms : words[0] == "Velocities" ? Section::velocities : Section::other;
    const std::size_t mark = line.find('#');
    if (!atoms || mark == std::string_view::npos) return;
    const Words style = cells_of(line.substr(mark + 1), ' ');
    if (!style.empty() && style[0] != "sphere")
      file_.refuse(
          "the atoms are of another style than sphere, which has diameters; write them with atom_style sphere");
  }

  // id type diameter density x y z, and three images that nobody asks for.
  void take_atom(const Words& words) {
    if (words.size() != 7 && words.size() != 10)
      file_.refuse(
          fmt::format("has {} words; an atom of style sphere is id type diameter density x y z", words.size()));
    const double diameter = number_of(file_, words, 2);
    if (!(diameter > 0.0)) file_.refuse("its diameter is not above 0: a point is no particle");
    Vec3 position{};
    for (std::size_t a = 0; a < 3; ++a) position[a] = number_of(file_, words, 4 + a);
    if (dimension_ == 2) position[2] = 0.0;
    const auto atom = static_cast<std::int64_t>(number_of(file_, words, 0));
    if (found_.total % ranks_ == rank_) {
      if (!slot_.emplace(atom, found_.rows.id.size()).second) file_.refuse("there is an atom of this id already");
      found_.rows.id.push_back(found_.total);
      found_.rows.position.push_back(position);
      found_.rows.radius.push_back(0.5 * diameter);
      found_.rows.velocity.push_back({});
      found_.rows.spin.push_back({});
      found_.rows.layer.push_back(0);
      found_.line.push_back(file_.number());
    }
    ++found_.total;
  }

  void take_velocity(const Words& words) {
    if (words.size() != 7) file_.refuse(fmt::format("has {} words; a velocity is id vx vy vz wx wy wz", words.size()));
    Vec3 velocity{}, spin{};
    for (std::size_t a = 0; a < 3; ++a)
      velocity[a] = number_of(file_, words, 1 + a), spin[a] = number_of(file_, words, 4 + a);
    velocities_ = true;
    const auto slot = slot_.find(static_cast<std::int64_t>(number_of(file_, words, 0)));
    if (slot == slot_.end()) return;  // another rank's
    found_.rows.velocity[slot->second] = velocity;
    found_.rows.spin[slot->second] = spin;
  }

  TextFile file_;
  int dimension_;
  Rank rank_;
  int ranks_;
  TextRows found_;
  Section section_ = Section::other;
  double atoms_ = 0.0;  // whatever the head says
  bool velocities_ = false;
  std::unordered_map<std::int64_t, std::size_t> slot_;  // of this rank's atoms, by LAMMPS' ids
};

}  // namespace

TextRows read_lammps(const std::string& path, int dimension, Rank rank, int ranks) {
  return Reader(path, dimension, rank, ranks).read();
}

}  // namespace packmpi::start
