#include "report/estimate.hpp"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "base/voids.hpp"

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_object(const Count& count) { return {{"value", count.value}, {"least", count.least}, {"most", count.most}}; }

std::string lengths(const std::vector<double>& size) {
  std::string text;
  for (const double length : size) text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", length);
  return fmt::format("[{}]", text);
}

std::string range(const Count& count) {
  if (count.least == count.most) return fmt::format("{}", count.value);
  return fmt::format("{} ({} to {})", count.value, count.least, count.most);
}

// What belongs into the scene that it does not say yet.
std::string answer(const Estimate& e) {
  if (e.found == "particles") return "";
  std::string text = fmt::format("the {} is found; for the scene:\n", e.found);
  text += e.other   ? fmt::format("  container.height = {:.6g}\n", e.size.back())
          : e.round ? fmt::format("  container.diameter = {:.6g}\n  container.height = {:.6g}\n", e.size[0], e.size[2])
                    : fmt::format("  container.size = {}\n", lengths(e.size));
  if (e.thickness_changed) text += fmt::format("  layers.thickness = {:.6g}\n", e.layer_thickness);
  return text;
}

std::string memory(std::int64_t bytes) { return text::bytes(static_cast<std::uint64_t>(bytes)); }

}  // namespace

std::string to_json(const Estimate& e) {
  Json root;
  root["format"] = "packmpi-estimate";
  root["format_version"] = 2;
  root["scene_file"] = e.scene_file;
  root["found"] = e.found;
  root["size"] = e.size;
  root["layer_thickness"] = e.layer_thickness;
  root["fraction"] = {{"value", e.fraction}, {"error", e.fraction_error}, {"given", e.fraction_given}};
  root["porosity"] = porosity(e.fraction);
  root["void_ratio"] = void_ratio(e.fraction);
  root["particles"] = to_object(e.particles);
  root["particles_a_layer"] = e.a_layer;
  root["layers"] = to_object(e.layers);
  root["height"] = e.height;
  root["steps"] = e.steps;
  root["relaxation_steps"] = e.relaxation_steps;
  if (e.confinement_steps > 0) root["confinement_steps"] = e.confinement_steps;
  root["particle_steps"] = e.particle_steps;
  root["duration"] = e.duration;
  root["at_most"] = e.at_most;
  root["ranks"] = e.ranks;
  root["most_ranks"] = e.most_ranks;
  root["ghost_share"] = e.ghosts;
  root["memory_of_a_rank"] = {{"settling", e.settling_bytes}, {"writing", e.writing_bytes}};
  root["files"] = {{"pack", e.pack_bytes}, {"checkpoint", e.checkpoint_bytes}, {"step_log", e.step_log_bytes}};
  if (e.search) {
    root["target"] = {{"samples", e.search->samples},
                      {"particles", e.search->particles},
                      {"particle_steps", e.search->particle_steps}};
  }
  if (e.probe) {
    root["probe"] = {{"particles", e.probe->particles},
                     {"steps", e.probe->steps},
                     {"seconds", e.probe->seconds},
                     {"particle_steps_per_second", e.probe->particle_steps_per_second},
                     {"insertions_per_second", e.probe->insertions_per_second}};
    root["wall_seconds"] = e.seconds;
  }
  root["warnings"] = e.warnings;
  root["units"] = {{"size", "m"},
                   {"layer_thickness", "m"},
                   {"height", "m"},
                   {"duration", "s"},
                   {"memory_of_a_rank", "bytes"},
                   {"files", "bytes"},
                   {"seconds", "s"},
                   {"wall_seconds", "s"},
                   {"particle_steps_per_second", "1/s"},
                   {"insertions_per_second", "1/s"}};
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_table(const Estimate& e) {
  fmt::memory_buffer out;
  const auto line = [&](std::string_view what, const std::string& words) {
    fmt::format_to(std::back_inserter(out), "  {:<44} {}\n", what, words);
  };
  const std::string most = e.at_most ? ", at most" : "";
  fmt::format_to(std::back_inserter(out), "{}, {} rank{}\n{}", e.scene_file, e.ranks, e.ranks == 1 ? "" : "s",
                 answer(e));
  line("container [m]", lengths(e.size));
  line("solid fraction of the bed",
       fmt::format("{:.4f} +- {:.3f}{}", e.fraction, e.fraction_error, e.fraction_given ? ", as given" : ""));
  line("porosity, void ratio", fmt::format("{:.4f}, {:.4f}", porosity(e.fraction), void_ratio(e.fraction)));
  line("particles", range(e.particles));
  const bool whole = e.particles.value == e.layers.value * e.a_layer;  // not those that end at H_d
  line("layers", fmt::format("{}, of {} particles {}", range(e.layers), e.a_layer, whole ? "each" : "at most"));
  line("height of the bed [m]", fmt::format("{:.4g}", e.height));
  line("time steps", fmt::format("{}{}, {} of them in the final stage", e.steps, most, e.relaxation_steps));
  if (e.confinement_steps > 0) line("time steps of confinement, about", fmt::format("{}", e.confinement_steps));
  line("simulated time [s]", fmt::format("{:.4g}{}", e.duration, most));
  line("particle-steps", fmt::format("{:.3g}{}", static_cast<double>(e.particle_steps), most));
  line("most ranks the columns allow", fmt::format("{}", e.most_ranks));
  line("copies of other ranks' particles, by own", fmt::format("{:.3g}", e.ghosts));
  line("memory of a rank, while layers settle", memory(e.settling_bytes));
  line("memory of a rank, while a file is written", memory(e.writing_bytes));
  line("pack", memory(e.pack_bytes));
  line("checkpoints, two of", memory(e.checkpoint_bytes));
  line("time series, about", memory(e.step_log_bytes));
  if (e.search) {
    line("target: samples to find the friction, at most",
         fmt::format("{} of {} particles: {:.3g} particle-steps", e.search->samples, e.search->particles,
                     static_cast<double>(e.search->samples * e.search->particle_steps)));
  }
  if (e.probe) {
    line("probe", fmt::format("{} particles, {} steps: {:.3g}e6 particle-steps/s a rank", e.probe->particles,
                              e.probe->steps, 1e-6 * e.probe->particle_steps_per_second));
    line("wall time, about", text::duration(e.seconds) + most);
  }
  for (const std::string& warning : e.warnings) {
    fmt::format_to(std::back_inserter(out), "warning: {}\n", warning);
  }
  return fmt::to_string(out);
}

}  // namespace packmpi::report
