#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/voids.hpp"
#include "report/composition_words.hpp"
#include "report/report.hpp"
#include "report/size_words.hpp"

namespace packmpi::report {
namespace {

using Buffer = fmt::memory_buffer;

std::string number(double value) { return fmt::format("{:.5g}", value); }
std::string number(std::int64_t value) { return fmt::format("{}", value); }

void line(Buffer& out, std::string_view quantity, std::string_view target, std::string_view achieved) {
  fmt::format_to(std::back_inserter(out), "  {:<44} {:>22} {:>22}\n", quantity, target, achieved);
}

std::string limit_words(const Criterion& c) {
  if (!c.asked()) return "";
  return c.target == 0.0 ? fmt::format("< {:g}", c.limit) : fmt::format("{:g} +- {:g}", c.target, c.limit);
}

void list_density(Buffer& out, const RunRecord& r) {
  const bool asked = r.insertion_alone && r.target_particles == 0;
  const char* below = r.confined.on ? "below the lid" : "below the target height";
  line(out, fmt::format("solid fraction {}, phi", below), asked ? number(r.target_fraction) : "", number(r.phi));
  line(out, fmt::format("porosity {}, 1 - phi", below), "", number(porosity(r.phi)));
  line(out, "void ratio there, (1 - phi) / phi", "", number(void_ratio(r.phi)));
  const bool here = r.density.on() && !r.density_is_before_stress();
  const auto wanted = [&](double (*words)(double)) { return here ? number(words(r.density.fraction)) : std::string(); };
  line(out, "solid fraction in the bulk, phi_bulk", wanted([](double phi) { return phi; }), number(r.phi_bulk));
  line(out, "porosity in the bulk", wanted(porosity), number(porosity(r.phi_bulk)));
  line(out, "void ratio in the bulk", wanted(void_ratio), number(void_ratio(r.phi_bulk)));
}

void list_stress(Buffer& out, const RunRecord& r) {
  const confine::Outcome& c = r.confined;
  if (!c.on) return;
  const std::string lateral = c.lateral > 0.0 ? number(c.lateral) : "";
  line(out, "height of the lid [m]", "", number(c.lid));
  line(out, "stress on the lid [Pa]", number(c.vertical), number(c.on_lid));
  line(out, "stress of the contacts, vertical [Pa]", number(c.vertical_at_rest), number(c.of_contacts.back()));
  for (std::size_t a = 0; a < c.size.size(); ++a) {
    line(out, fmt::format("stress of the contacts, {} [Pa]", "xy"[a]), lateral, number(c.of_contacts[a]));
    if (c.on_sides[a] > 0.0)
      line(out, fmt::format("stress on the wall {} [Pa]", "xy"[a]), lateral, number(c.on_sides[a]));
  }
  line(out, c.lateral > 0.0 ? "lateral over vertical stress" : "lateral over vertical stress, K0", "", number(c.ratio));
  const bool wanted = r.density.on() && r.density_is_before_stress();
  line(out, "solid fraction in the bulk before the lid", wanted ? number(r.density.fraction) : "",
       number(c.phi_before));
}

/// The middle column has targets only.
void compare(Buffer& out, const RunRecord& r) {
  fmt::format_to(std::back_inserter(out), "{:.96}\n", r.name);
  line(out, "quantity", "target", "achieved");
  line(out, "particles", r.target_particles > 0 ? number(r.target_particles) : "", number(r.particles));
  const bool by_height = r.target_particles == 0 && !r.insertion_alone;
  line(out, "height [m]", by_height ? number(r.target_height) : "", number(r.height));
  line(out, "highest top [m]", "", number(r.top));
  list_density(out, r);
  list_stress(out, r);
  line(out, "compaction rate left, d phi_bulk / dt [1/s]", "", number(r.compaction_rate));
  line(out, "mean radius [m]", number(r.target_mean_radius), number(r.mean_radius));
  line(out, "standard deviation of the radius [m]", number(r.target_sd_radius), number(r.sd_radius));
  line(out, "smallest radius [m]", number(r.target_min_radius), number(r.min_radius));
  line(out, "largest radius [m]", number(r.target_max_radius), number(r.max_radius));
  if (r.target_min_radius < r.target_max_radius) {
    for (const SizeLine& size : size_lines(r.sizes)) line(out, size.quantity, size.target, size.achieved);
  }
  for (const SizeLine& of : composition_lines(r.composition, r.component_masses))
    line(out, of.quantity, of.target, of.achieved);
  line(out, "coordination number", "", number(r.rest.network.coordination));
  line(out, "coordination number without rattlers", "", number(r.rest.network.held_coordination));
  line(out, "rattlers, share", "", number(r.rest.network.rattlers));
  for (const Criterion& c : r.criteria) line(out, c.words, limit_words(c), number(c.value));
  line(out, "wall penetration / radius, worst", "", number(r.audit.worst_wall_penetration));
  if (r.confined.on) {
    line(out, "force on the floor [N]", "", number(r.floor_force));  // the lid's too
  } else {
    line(out, "force on the floor [N] (target: the weight)", number(r.weight), number(r.floor_force));
  }
  line(out, "kinetic energy [J]", "", number(r.kinetic_energy));
  line(out, "particles lost", "0", number(r.audit.expected - r.audit.found));
  line(out, "particles not finite", "0", number(r.audit.non_finite));
  line(out, "particles outside", "0", number(r.audit.outside));
  line(out, "time step [s]", "", number(r.time_step));
  line(out, "steps", "", number(r.steps));
  line(out, "stopped because", "", r.stop_reason.substr(0, 22));
}

void list_layers(Buffer& out, const RunRecord& r) {
  constexpr const char* head = "  {:>5} {:>9} {:>10} {:>6} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:<8}\n";
  constexpr const char* row =
      "  {:>5} {:>9} {:>10} {:>6.4f} {:>6.4f} {:>8.4g} {:>8.4g} {:>8} {:>8.1e} {:>8.1e} {:<8.8}\n";
  fmt::format_to(std::back_inserter(out), fmt::runtime(head), "layer", "inserted", "total", "target", "achieved",
                 "height m", "top m", "steps", "E/mgd", "overlap", "stop");
  for (std::size_t k = 0; k < r.layers.size(); ++k) {
    const LayerRow& layer = r.layers[k];
    fmt::format_to(std::back_inserter(out), fmt::runtime(row), k + 1, layer.inserted, layer.total,
                   layer.target_fraction, layer.achieved_fraction, layer.height, layer.top, layer.steps,
                   layer.kinetic_per_mgd, layer.max_overlap, layer.stop_reason);
  }
}

void row(Buffer& out, std::string_view name, std::string_view sum, std::string_view max, std::string_view imbalance) {
  fmt::format_to(std::back_inserter(out), "  {:<40} {:>22} {:>22} {:>8}\n", name, sum, max, imbalance);
}

// Times in seconds, memory in megabytes; bytes sent stay exact.
std::string amount(const RankNumbers& numbers, std::int64_t value, bool exact) {
  if (numbers.unit == "ns") return fmt::format("{:.3f}", static_cast<double>(value) * 1e-9);
  if (numbers.unit == "B" && !exact) return fmt::format("{:.1f}", static_cast<double>(value) * 1e-6);
  return number(value);
}

void list_numbers(Buffer& out, const std::vector<RankNumbers>& all, bool exact) {
  for (const RankNumbers& numbers : all) {
    if (numbers.max() == 0) continue;
    std::string name = numbers.name;
    std::ranges::replace(name, '_', ' ');
    if (numbers.unit == "ns") name += " [s]";
    if (numbers.unit == "B" && !exact) name += " [MB]";
    row(out, name, amount(numbers, numbers.sum(), exact), amount(numbers, numbers.max(), exact),
        fmt::format("{:.3f}", numbers.imbalance()));
  }
}

// What it cost: nothing where nothing was counted.
void list_counters(Buffer& out, const RunRecord& r) {
  if (r.counters.empty()) return;
  row(out, fmt::format("counted on {} rank{}", r.ranks, r.ranks == 1 ? "" : "s"), "sum", "max", "max/mean");
  list_numbers(out, r.counters, true);
  list_numbers(out, r.costs, false);
  fmt::format_to(std::back_inserter(out), "  moving share of the particles {:.4f}", moving_share(r));
  const RankNumbers* memory = find(r.costs, "memory");
  if (memory != nullptr && r.particles > 0) {
    fmt::format_to(std::back_inserter(out), "; bytes a particle {:.0f} allocated, {:.0f} resident with libraries",
                   r.bytes_per_particle, static_cast<double>(memory->sum()) / static_cast<double>(r.particles));
  }
  fmt::format_to(std::back_inserter(out), "\n");
}

}  // namespace

std::string to_table(const RunRecord& record) {
  Buffer out;
  compare(out, record);
  list_layers(out, record);
  list_counters(out, record);
  return fmt::to_string(out);
}

}  // namespace packmpi::report
