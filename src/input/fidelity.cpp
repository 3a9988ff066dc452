#include "input/fidelity.hpp"

#include <fmt/format.h>

#include <cmath>

#include "input/keys.hpp"
#include "input/values.hpp"

namespace packmpi::input {
namespace {

/// A protocol without units. Times are in t = sqrt(2 h_0 / g), that of a fall through a layer's region, speeds in
/// sqrt(2 g h_0); the paper's 1.0 s is 3.16 t in its examples.
struct Protocol {
  double duration;  ///< of a layer
  double speed;     ///< at insertion, downward
  double softness;  ///< modulus while layers settle, over that of the particles; 1: no other one
  int window;
  double thaw;
};

/// Measured and chosen by scripts/tradeoff.py (doc/accuracy.md).
Protocol protocol_of(const Input& in) {
  if (in.fidelity == "balanced") return {1.1, 0.5, 1.0, 0, 1.9};
  return {1.0, 0.5, 0.1, 5, 1.9};
}

/// Three digits, the same on any machine.
std::string rounded(double value) { return fmt::format("{:.3g}", value); }

std::string downward(const Input& in, double speed) {
  const std::string zeros = in.container.dimension == 3 ? "0, 0" : "0";
  return fmt::format("[{}, -{}]", zeros, rounded(speed));
}

}  // namespace

std::vector<PresetValue> preset(const Input& in) {
  if (in.fidelity == "paper") {
    return {{"layers.duration", "1.0"}, {"dynamics.time_step", "1e-4"}, {"dynamics.window", "0"}};
  }
  const double h = in.layers.thickness, g = in.jamming.gravity;
  const Protocol protocol = protocol_of(in);
  const double fall = std::sqrt(2.0 * h / g);
  std::vector<PresetValue> values{{"layers.duration", rounded(protocol.duration * fall)},
                                  {"layers.velocity", downward(in, protocol.speed * g * fall)},
                                  {"dynamics.time_step", "auto"},
                                  {"dynamics.window", std::to_string(protocol.window)},
                                  {"dynamics.thaw", rounded(protocol.thaw * fall)}};
  if (protocol.softness < 1.0) {
    values.push_back({"layers.youngs_modulus", rounded(protocol.softness * in.particles.youngs_modulus)});
  }
  return values;
}

void apply_preset(const Document& document, Input& in) {
  const Node* named = document.find("fidelity");
  if (named == nullptr) return;
  if (in.fidelity != "paper" && !(in.jamming.gravity > 0.0)) {
    fail(named->place, "fidelity",
         fmt::format("\"{}\" measures times by the free fall through a layer, and there is no gravity; use \"paper\"",
                     in.fidelity));
  }
  for (const PresetValue& entry : preset(in)) {
    if (document.find(entry.path) == nullptr) {
      store(*find_key(entry.path), parse_value(entry.value, named->place), in);
    }
  }
}

std::vector<std::string> preset_in_use(Input in) {
  std::vector<std::string> lines;
  for (const PresetValue& entry : preset(in)) {
    const Key& key = *find_key(entry.path);
    Input other = in;
    store(key, parse_value(entry.value, "preset"), other);
    const std::string here = written(key, in), there = written(key, other);
    lines.push_back(fmt::format("{} = {}", entry.path, here));
    if (here != there) lines.back() += fmt::format(" (the preset: {})", there);
  }
  return lines;
}

}  // namespace packmpi::input
