#include "input/fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "input/keys.hpp"
#include "input/radius_range.hpp"
#include "input/time_step.hpp"
#include "input/values.hpp"

namespace packmpi::input {

using document::fail;
using document::Node;
using document::parse_value;

namespace {

/// How a pack is made. The preset's keys, in SI units.
struct Protocol {
  double duration = 0.0;  ///< [s] of a layer
  double speed = 0.0;     ///< [m/s] at insertion, downward
  int window = 0;
  double relaxation = 0.0;  ///< [s]
  double modulus = 0.0;     ///< [Pa] while layers settle
};

// Times of presets are in t, that of a fall through a layer's region, speeds in sqrt(2 g h_0) = g t.
bool is_draft(const Input& in) { return in.fidelity == "draft"; }
bool remembers(const Input& in) { return in.contact.tangential == Tangential::mindlin; }
bool flat(const Input& in) { return in.container.dimension == 2; }

/// NaN, of a scene that checks will refuse: high.
double within(double value, double low, double high) { return std::fmax(low, std::fmin(high, value)); }

/// How soft layers may settle.
struct Softness {
  double share;   ///< of the particles' modulus
  double weight;  ///< modulus over rho g H_d, the stress of a solid bed on its floor: less, and it bursts in the final
                  ///< relaxation
};

/// At least `wanted` [Pa]; that of the particles if it would gain little to soften them. A large particle presses a
/// small one with the square of their ratio: beyond a ratio of five, layers are stiffer by as much.
double softened(const Input& in, const Softness& softness, double wanted) {
  constexpr double worth_it = 0.75, modest = 5.0;
  const double hard = in.particles.youngs_modulus;
  const double stress = in.particles.density * in.jamming.gravity * in.container.size.back();
  const RadiusRange radii = radius_range(in.particles.radius);
  const double squeeze = std::fmax(1.0, radii.largest / (modest * radii.smallest));
  const double soft =
      std::max({wanted, softness.share * hard * squeeze * squeeze * squeeze * squeeze, softness.weight * stress});
  return soft < worth_it * hard ? soft : hard;
}

/// A protocol in the plane: constants without units.
struct Flat {
  double duration, speed;
  int window;
  double relaxation;  ///< for each h_0 of H_d: the deeper a bed, the longer it takes to find its rest
  double least_relaxation;
};

Protocol in_plane(const Input& in, const Flat& flat) {
  const bool soft = is_draft(in) || in.dynamics.rotation;  // soft layers without spin settle too densely
  const double t = fall_time(in), layers = in.container.size.back() / in.layers.thickness;
  return {.duration = flat.duration * t,
          .speed = flat.speed * in.jamming.gravity * t,
          .window = flat.window,
          .relaxation = std::max(flat.least_relaxation, flat.relaxation * layers) * t,
          .modulus = soft ? softened(in, {0.1, 5e3}, 0.0) : in.particles.youngs_modulus};
}

/// What a bed is to creep by over what it creeps by under "paper".
struct Creep {
  double multiple;     ///< at d = h_0 and the usual friction
  double by_size;      ///< power of d / h_0
  double by_friction;  ///< power of the usual friction over the scene's: rough particles densify more for as much creep
};

/// A protocol in space: how long layers settle, and how softly, follows from the creep that they are to have.
struct Spatial {
  double speed;  ///< at insertion
  Creep creep;
  double duration;  ///< of a layer, if some softness makes up the creep with it
  double shortest;  ///< of a layer
  double depth;     ///< of the window, in particle diameters
  int least_window;
  double relaxation;
  double relaxation_of_layer;  ///< and more for each h_0 of H_d: the deeper a bed, the longer it takes to find its rest
  Softness softness;
};

double over_paper(const Input& in, const Creep& creep, double diameter) {
  constexpr double usual = 0.2, least = 0.1, any = 1e6;
  const double size = within(diameter / in.layers.thickness, 1.0 / any, any);
  const double friction = within(in.contact.friction, least, any);
  return creep.multiple * elementary::power(size, creep.by_size) *
         elementary::power(usual / friction, creep.by_friction);
}

/// A bed under "stop" creeps with the step: within one its weight gives a resting contact a slip of g dt^2, so that in
/// a time T it creeps by g dt T, and the denser it is the more it has crept. "paper" gives a layer 1 s at steps of 1e-4
/// s, 1e-3 t^2 in its examples, and all that lies below as much again: (n + 1) / 2 times that for the mean particle of
/// n layers. Here it moves in fewer layers, in larger steps, for shorter (doc/theory.md, "Presets"). Where the shortest
/// layers would let it creep by too much, the final relaxation is a little shorter.
Protocol in_space(Input in, const Spatial& rule) {
  constexpr double settled_fraction = 0.6, paper = 1e-3, longest = 1.5, least_relaxation = 0.95;
  constexpr int most_window = 1000;
  const double t = fall_time(in), h = in.layers.thickness, height = in.container.size.back();
  const RadiusRange radii = radius_range(in.particles.radius);
  const double diameter = 2.0 * std::sqrt(radii.smallest) * std::sqrt(radii.largest);
  const double rise = h * in.layers.fraction / settled_fraction;  // of the bed by a layer
  Protocol p{
      .speed = rule.speed * in.jamming.gravity * t,
      .window = static_cast<int>(within(std::ceil(rule.depth * diameter / rise), rule.least_window, most_window)),
      .relaxation = (rule.relaxation + rule.relaxation_of_layer * height / h) * t,
      .modulus = in.particles.youngs_modulus};
  in.layers.velocity[in.container.size.size() - 1] = -p.speed;
  const double layers = std::max(height / rise, 1.0);
  const double moving = std::min(static_cast<double>(p.window), layers);
  const double settlings = moving - moving * (moving - 1.0) / (2.0 * layers);  // in how many the mean particle moves
  const double step = automatic_step(in, radii, p.modulus);
  const double creep = over_paper(in, rule.creep, diameter) * 0.5 * (layers + 1.0) * paper * t * t;
  const double left = creep - p.relaxation * step;  // for the layers
  const double ratio =
      left / (settlings * rule.duration * t) / step;  // wanted step of layers over that of the final relaxation
  const double wanted =
      ratio > 1.0 ? p.modulus / (ratio * ratio * std::sqrt(ratio)) : p.modulus;  // dt goes with E^-0.4
  p.modulus = softened(in, rule.softness, wanted);
  const double of_layers = settlings * automatic_step(in, radii, p.modulus);  // creep over their duration
  p.duration = within(left / (of_layers * t), rule.shortest, longest) * t;
  p.relaxation = within((creep - of_layers * p.duration) / step, least_relaxation * p.relaxation, p.relaxation);
  return p;
}

/// A protocol for friction with memory. What has come to rest stays there, so there is no creep to match: layers get
/// the time to settle, the newest ones move, and the final stage goes on until the bed is at rest. Times in falls.
struct Holding {
  double duration;    ///< of a layer
  double speed;       ///< at insertion, in g t: what falls faster is there sooner
  double depth;       ///< of the window, in particle diameters; 0: all move
  double relaxation;  ///< at least; particles harden in half of it
  Softness softness;
};

Protocol with_memory(const Input& in, const Holding& rule) {
  constexpr double settled_fraction = 0.6, most_window = 1000.0, least_window = 4.0;
  const double t = fall_time(in), h = in.layers.thickness;
  const RadiusRange radii = radius_range(in.particles.radius);
  const double diameter = 2.0 * std::sqrt(radii.smallest) * std::sqrt(radii.largest);
  const double rise = h * in.layers.fraction / settled_fraction;  // of the bed by a layer
  const double window = within(std::ceil(rule.depth * diameter / rise), least_window, most_window);
  return {.duration = rule.duration * t,
          .speed = rule.speed * in.jamming.gravity * t,
          .window = rule.depth > 0.0 ? static_cast<int>(window) : 0,
          .relaxation = rule.relaxation * t,
          .modulus = softened(in, rule.softness, 0.0)};
}

/// Measured with scripts/study/presets.py (doc/accuracy.md): "reference" is what halving the step or doubling the
/// durations does not change; "balanced" and "draft" are held to it. Only "draft" settles soft: hardening costs
/// contacts for good, and a slow one locks in the sideways stress of the soft bed, so it is sudden.
Protocol with_memory(const Input& in) {
  constexpr Softness hard{1.0, 0.0};
  if (in.fidelity == "reference") return with_memory(in, {5.0, 0.0, 0.0, 2.5, hard});
  if (is_draft(in)) return with_memory(in, {0.9, 0.0, 6.0, 0.2, {0.1, 1.3e3}});
  return with_memory(in, {1.2, 0.3, 10.0, 3.0, hard});
}

/// All measured and chosen with scripts/study/tradeoff.py (doc/accuracy.md). What creep is wanted depends on the
/// rotation: with it particles roll past each other as well.
Protocol draft(const Input& in) {
  if (flat(in))
    return in_plane(in, {.duration = 0.9, .speed = 0.5, .window = 5, .relaxation = 0.4, .least_relaxation = 1.0});
  const bool rolls = in.dynamics.rotation;
  return in_space(in, {.speed = 0.6,
                       .creep = rolls ? Creep{1.65, 0.5, 0.25} : Creep{0.75, 0.0, 0.35},
                       .duration = 0.6,
                       .shortest = 0.6,
                       .depth = 3.5,
                       .least_window = 3,
                       .relaxation = 0.55,
                       .relaxation_of_layer = 0.1,
                       .softness = {0.03, 1.3e3}});
}

Protocol balanced(const Input& in) {
  constexpr double rest = 2.4;  // particles harden in half of it
  const bool rolls = in.dynamics.rotation;
  if (flat(in) && rolls)
    return in_plane(in, {.duration = 1.2, .speed = 0.5, .window = 6, .relaxation = 0.9, .least_relaxation = rest});
  if (flat(in))
    return in_plane(in, {.duration = 0.7, .speed = 0.75, .window = 5, .relaxation = 0.58, .least_relaxation = rest});
  return in_space(in, {.speed = rolls ? 0.3 : 0.2,
                       .creep = rolls ? Creep{2.45, 0.5, 0.25} : Creep{1.14, 0.15, 0.35},
                       .duration = rolls ? 0.8 : 0.75,
                       .shortest = 0.7,
                       .depth = 5.6,
                       .least_window = 5,
                       .relaxation = rolls ? 1.9 : 2.0,
                       .relaxation_of_layer = 0.18,
                       .softness = {0.06, 2e3}});
}

/// Three digits, the same on any machine.
std::string rounded(double value) { return fmt::format("{:.3g}", value); }

std::string downward(const Input& in, double speed) {
  return fmt::format("[{}, -{}]", flat(in) ? "0" : "0, 0", rounded(speed));
}

}  // namespace

std::vector<PresetValue> preset(const Input& in) {
  if (in.fidelity == "paper") {
    return {{"layers.duration", "1.0"},     {"dynamics.time_step", "1e-4"},
            {"dynamics.window", "0"},       {"contact.regularisation", "\"stop\""},
            {"rest.unbalanced_force", "1"}, {"rest.kinetic_energy", "0.1"},
            {"rest.support", "0.2"},        {"rest.wait", "0"}};
  }
  const Protocol protocol = remembers(in) ? with_memory(in) : (is_draft(in) ? draft(in) : balanced(in));
  std::vector<PresetValue> values{{"layers.duration", rounded(protocol.duration)},
                                  {"dynamics.time_step", "auto"},
                                  {"dynamics.window", std::to_string(protocol.window)},
                                  {"dynamics.relaxation", rounded(protocol.relaxation)}};
  if (protocol.speed > 0.0) values.push_back({"layers.velocity", downward(in, protocol.speed)});
  const bool soft = protocol.modulus < in.particles.youngs_modulus;
  if (soft) values.push_back({"layers.youngs_modulus", rounded(protocol.modulus)});
  return values;
}

std::optional<std::string_view> preset_law(const Document& document, std::string_view path, const Input& in) {
  if (insertion_alone(in)) return path == "jamming.gravity" ? std::optional("0.0") : std::nullopt;
  const bool named = document.find("fidelity") != nullptr && in.fidelity != "paper";
  return named && path == "contact.tangential" ? std::optional("\"mindlin\"") : std::nullopt;
}

void apply_preset(const Document& document, Input& in) {
  const Node* named = document.find("fidelity");
  if (named == nullptr || insertion_alone(in)) return;
  if (in.fidelity != "paper" && !(in.jamming.gravity > 0.0)) {
    fail(named->place, "fidelity",
         fmt::format("\"{}\" measures times by the free fall through a layer, and there is no gravity; use \"paper\"",
                     in.fidelity));
  }
  if (in.fidelity == "reference" && !remembers(in)) {
    fail(named->place, "fidelity",
         "\"reference\" needs friction that holds at rest; use contact.tangential = \"mindlin\"");
  }
  for (const PresetValue& entry : preset(in)) {
    if (document.find(entry.path) == nullptr) {
      store(*find_key(entry.path), parse_value(entry.value, named->place), in);
    }
  }
}

std::vector<std::string> preset_in_use(Input in) {
  std::vector<std::string> lines;
  if (insertion_alone(in)) return lines;
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

PresetOverrides preset_overrides(Input in) {
  PresetOverrides found{.words = {}, .as_preset = in};
  if (insertion_alone(in)) return found;
  for (const PresetValue& entry : preset(in)) {
    const Key& key = *find_key(entry.path);
    const std::string here = written(key, in);
    store(key, parse_value(entry.value, "preset"), found.as_preset);
    const std::string there = written(key, found.as_preset);
    if (here != there) found.words.push_back(fmt::format("{} = {} (the preset: {})", entry.path, here, there));
  }
  return found;
}

}  // namespace packmpi::input
