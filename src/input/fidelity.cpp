#include "input/fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>
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
  int window;
  double thaw;  ///< for each h_0 of H_d: the deeper a pile, the longer it takes to find its rest
};

/// How soft layers may settle.
struct Softness {
  double share;   ///< of the particles' modulus
  double weight;  ///< modulus over rho g H_d, the stress of a solid pile on its floor: less, and it bursts in the thaw
};

bool is_draft(const Input& in) { return in.fidelity == "draft"; }
bool is_graded(const Input& in) { return in.particles.radius.distribution != SizeDistribution::equal; }

bool flat(const Input& in) { return in.container.dimension == 2; }

/// Modulus while layers settle [Pa]; that of the particles if it would gain little to soften them. Soft layers without
/// spin settle too densely for "balanced".
double soft_modulus(const Input& in) {
  constexpr double worth_it = 0.75;
  const double hard = in.particles.youngs_modulus;
  if (!is_draft(in) && !in.dynamics.rotation) return hard;
  const Softness softness = is_draft(in) && is_graded(in) && !flat(in) ? Softness{0.03, 1.5e3} : Softness{0.1, 5e3};
  const double stress = in.particles.density * in.jamming.gravity * in.container.size.back();
  const double soft = std::max(softness.share * hard, softness.weight * stress);
  return soft < worth_it * hard ? soft : hard;
}

/// Both measured and chosen with scripts/tradeoff.py (doc/accuracy.md).
Protocol draft(const Input& in) {
  if (flat(in)) return {.duration = 0.9, .speed = 0.5, .window = 5, .thaw = 0.4};
  if (is_graded(in)) return {.duration = 0.65, .speed = 0.75, .window = 4, .thaw = 0.2};
  return {.duration = 0.8, .speed = 0.75, .window = 4, .thaw = 0.26};
}

Protocol balanced(const Input& in) {
  if (!in.dynamics.rotation) return {.duration = 0.7, .speed = 0.75, .window = 5, .thaw = 0.58};
  if (flat(in)) return {.duration = 1.2, .speed = 0.5, .window = 6, .thaw = 0.9};
  return {.duration = 1.0, .speed = 0.5, .window = 5, .thaw = 0.6};
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
  const double modulus = soft_modulus(in);
  const bool soft = modulus < in.particles.youngs_modulus;
  const Protocol protocol = is_draft(in) ? draft(in) : balanced(in);
  const double fall = std::sqrt(2.0 * h / g);
  const double layers = in.container.size.back() / h;
  const double least_thaw = is_draft(in) ? 1.0 : 2.4;  // particles harden in half of it
  std::vector<PresetValue> values{{"layers.duration", rounded(protocol.duration * fall)},
                                  {"layers.velocity", downward(in, protocol.speed * g * fall)},
                                  {"dynamics.time_step", "auto"},
                                  {"dynamics.window", std::to_string(protocol.window)},
                                  {"dynamics.thaw", rounded(std::max(least_thaw, protocol.thaw * layers) * fall)}};
  if (soft) values.push_back({"layers.youngs_modulus", rounded(modulus)});
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
