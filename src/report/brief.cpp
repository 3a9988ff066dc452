#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "base/text.hpp"
#include "base/voids.hpp"
#include "report/report.hpp"

namespace packmpi::report {
namespace {

using Buffer = fmt::memory_buffer;

/// In which a length is a number from 1 to 1000, or the nearest to that there is.
struct LengthUnit {
  double factor;
  const char* name;
};

LengthUnit unit_of(double length) {
  for (const auto& [limit, unit] : {std::pair(1e-6, LengthUnit{1e9, "nm"}), std::pair(1e-3, LengthUnit{1e6, "µm"}),
                                    std::pair(1.0, LengthUnit{1e3, "mm"})}) {
    if (std::abs(length) < limit) return unit;
  }
  return {1.0, "m"};
}

std::string in_unit(double length) {
  const LengthUnit unit = unit_of(length);
  return fmt::format("{:.4g} {}", unit.factor * length, unit.name);
}

template <class... Words>
void say(Buffer& out, std::string_view name, fmt::format_string<Words...> form, Words&&... words) {
  fmt::format_to(std::back_inserter(out), "  {:<10}", name);
  fmt::format_to(std::back_inserter(out), form, std::forward<Words>(words)...);
  out.push_back('\n');
}

// "rest.support, target.porosity": the log has a sentence on each.
std::string missed_keys(const RunRecord& r) {
  std::string keys;
  for (const std::string& words : r.missed) keys += (keys.empty() ? "" : ", ") + words.substr(0, words.find(':'));
  return text::printable(keys);
}

std::string container_words(const RunRecord& r) {
  const auto axes = static_cast<std::size_t>(r.dimension);
  double longest = 0.0;
  for (std::size_t a = 0; a < axes; ++a) longest = std::fmax(longest, r.size[a]);
  const LengthUnit unit = unit_of(longest);
  std::string words;
  for (std::size_t a = 0; a < axes; ++a)
    words += fmt::format("{}{:.4g}", words.empty() ? "" : " x ", unit.factor * r.size[a]);
  return words + " " + unit.name;
}

void say_density(Buffer& out, const RunRecord& r) {
  const double phi = r.insertion_alone ? r.phi : r.phi_bulk;
  std::string asked;
  if (r.density.on()) {
    asked = fmt::format("; asked {:.4g} +- {:g}", r.density.fraction, r.density.tolerance);
    if (r.density_is_before_stress())
      asked += fmt::format(" before the lid, when it was {:.4f}", r.confined.phi_before);
  }
  if (r.insertion_alone && r.target_particles == 0) asked = fmt::format("; asked {:.4g}", r.target_fraction);
  say(out, "density", "solid fraction {:.4f}, porosity n {:.4f}, void ratio e {:.4f}{}{}", phi, porosity(phi),
      void_ratio(phi), r.insertion_alone ? "" : " in the bulk", asked);
}

void say_sizes(Buffer& out, const RunRecord& r) {
  if (r.target_min_radius == r.target_max_radius) {
    say(out, "diameter", "{}", in_unit(2.0 * r.mean_radius));
    return;
  }
  const auto& got = r.sizes.by_mass.achieved;
  const auto& asked = r.sizes.by_mass.target;
  const LengthUnit unit = unit_of(2.0 * r.max_radius);
  say(out, "diameters", "D50 by mass {:.4g} {}, asked {:.4g}; from {:.4g} to {:.4g}", unit.factor * got.d50, unit.name,
      unit.factor * asked.d50, 2.0 * unit.factor * r.min_radius, 2.0 * unit.factor * r.max_radius);
}

void say_stress(Buffer& out, const confine::Outcome& c) {
  if (!c.on) return;
  say(out, "stress", "{:.4g} kPa on the lid, asked {:.4g}; lateral over vertical {:.3f}", 1e-3 * c.on_lid,
      1e-3 * c.vertical, c.ratio);
}

std::string rest_words(const Criterion& c) {
  const std::string_view name = c.name;
  const std::string limit = c.asked() && c.target == 0.0 ? fmt::format(" (< {:g})", c.limit) : "";
  if (name == "unbalanced_force") return fmt::format("unbalanced force {:.2g}{}", c.value, limit);
  if (name == "kinetic_energy") return fmt::format("kinetic energy {:.2g} m g d{}", c.value, limit);
  if (name == "support") return fmt::format("{:.3f} of the weight borne", c.value);
  return "";
}

void say_rest(Buffer& out, const RunRecord& r) {
  std::string all;
  for (const Criterion& c : r.criteria) {
    const std::string words = rest_words(c);
    all += (all.empty() || words.empty() ? "" : ", ") + words;
  }
  if (!all.empty()) say(out, "rest", "{}", all);
}

// Those beside the pack have its name with another ending.
void say_files(Buffer& out, const std::vector<std::string>& files) {
  if (files.empty()) return;
  const std::string& pack = files.front();
  const std::string stem = pack.substr(0, pack.rfind('.'));
  std::string others;
  for (std::size_t k = 1; k < files.size(); ++k) {
    others += others.empty() ? "; beside it " : ", ";
    others += files[k].starts_with(stem) ? files[k].substr(stem.size()) : files[k];
  }
  say(out, "pack", "{}", text::printable(pack + others));
}

}  // namespace

std::string to_lines(const RunRecord& r, const std::vector<std::string>& files) {
  Buffer out;
  fmt::format_to(std::back_inserter(out), "{:.96}: {}\n", text::printable(r.name),
                 r.missed.empty() ? "done, all targets met" : "finished; missed: " + missed_keys(r));
  say(out, r.dimension == 2 ? "discs" : "spheres", "{} in {}{}", r.particles, container_words(r),
      r.target_particles > 0 ? fmt::format("; asked {}", r.target_particles) : "");
  if (!r.insertion_alone) {
    const bool by_height = r.target_particles == 0;
    say(out, "height", "{}{}", in_unit(r.height), by_height ? "; asked " + in_unit(r.target_height) : "");
  }
  say_density(out, r);
  say_sizes(out, r);
  say_stress(out, r.confined);
  if (!r.insertion_alone) {
    say(out, "contacts", "{:.2f} a particle, {:.2f} without the {:.1f} % rattlers; mean overlap {:.2g} radii",
        r.rest.network.coordination, r.rest.network.held_coordination, 100.0 * r.rest.network.rattlers,
        r.rest.mean_overlap);
    say_rest(out, r);
  }
  say(out, "made in", "{} on {} rank{}, {} steps; ended by {:.40}", text::duration(r.wall_seconds), r.ranks,
      r.ranks == 1 ? "" : "s", r.steps, r.stop_reason);
  say_files(out, files);
  return fmt::to_string(out);
}

}  // namespace packmpi::report
