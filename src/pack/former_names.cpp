#include "pack/former_names.hpp"

#include <array>
#include <sstream>
#include <string_view>

namespace packmpi::pack {
namespace {

struct Renamed {
  std::string_view before, now;
};

// As they stand in the text; nothing else in it has a quotation mark that is not escaped.
constexpr std::array state_names{Renamed{"\"creep\":", "\"compaction_rate\":"},
                                 Renamed{"\"thaws\":", "\"relaxations\":"},
                                 Renamed{"\"thaw_steps\":", "\"relaxation_steps\":"},
                                 Renamed{"\"height_before_thaw\":", "\"height_before_relaxation\":"},
                                 Renamed{"\"fraction_asked\":", "\"target_fraction\":"},
                                 Renamed{"\"fraction_got\":", "\"achieved_fraction\":"},
                                 Renamed{"\"phase\": \"thaw\"", "\"phase\": \"relaxation\""}};

// Beginnings of lines. What is nothing now is left out: packs of either precision are read alike.
constexpr std::array scene_names{Renamed{"thaw = ", "relaxation = "}, Renamed{"precision = ", ""}};

std::string line_now(const std::string& line) {
  for (const Renamed& name : scene_names) {
    if (!line.starts_with(name.before)) continue;
    return name.now.empty() ? "" : std::string(name.now) + line.substr(name.before.size()) + "\n";
  }
  return line + "\n";
}

}  // namespace

std::string scene_in_present_names(const std::string& scene) {
  std::istringstream lines(scene);
  std::string text;
  for (std::string line; std::getline(lines, line);) text += line_now(line);
  return text;
}

std::string state_in_present_names(std::string state) {
  for (const Renamed& name : state_names) {
    for (std::size_t at = 0; (at = state.find(name.before, at)) != std::string::npos; at += name.now.size()) {
      state.replace(at, name.before.size(), name.now);
    }
  }
  return state;
}

}  // namespace packmpi::pack
