// What there is to know of a scene, and to do with a pack file: include/packmpi/run.hpp.
#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "config/restitution.hpp"
#include "exporters/convert.hpp"
#include "forecast/advice.hpp"
#include "forecast/estimate.hpp"
#include "input/input.hpp"
#include "library/failure.hpp"
#include "packmpi/run.hpp"
#include "run/analyze.hpp"
#include "scene/ownership.hpp"
#include "start/fit.hpp"

namespace packmpi {
namespace {

std::string check_words(const scene::Scene& scene) {
  nlohmann::ordered_json facts;
  const double fraction = scene::expected_fraction(scene).value;
  facts["particles"] = scene::expected_filling(scene, fraction).particles;
  facts["time_step"] = scene.time_step;
  facts["time_step_limit"] = scene::safe_time_step(scene.in, scene.sizes);
  facts["most_ranks"] = scene::most_ranks(scene.columns(), scene.in.parallel.decomposition);
  facts["mean_overlap"] = scene::expected_overlap(scene, scene.in.particles.youngs_modulus);
  facts["restitution"] = input::restitution_of(scene.in.contact.damping_ratio, scene.in.contact.tension_cutoff);
  facts["remarks"] = scene.in.remarks;
  if (const std::string note = forecast::preset_note(scene); !note.empty()) facts["remarks"].push_back(note);
  facts["warnings"] = forecast::warnings_of(scene);
  return facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

exporters::Trim trim_of(const std::string& word) {
  if (word == "none") return exporters::Trim::none;
  if (word == "drop") return exporters::Trim::drop;
  if (word == "cut") return exporters::Trim::cut;
  throw Error(ExitCode::bad_input, fmt::format("trim = \"{}\": give \"none\", \"drop\" or \"cut\"", word));
}

}  // namespace

std::string check(const Scene& what, MPI_Comm world) {
  const comm::Comm comm(world);
  std::string words;
  library::together(comm, what.file(), [&] {
    const scene::Scene scene = scene::build(start::with_start(comm, what.input()));
    comm::agree_on(comm, [&] { words = check_words(scene); });
  });
  return words;
}

std::string estimate(const Scene& scene, MPI_Comm world, const EstimateOptions& options) {
  const comm::Comm comm(world);
  std::string words;
  library::together(comm, scene.file(), [&] {
    forecast::Question question;
    if (options.particles > 0) question.particles = options.particles;
    if (options.height > 0.0) question.height = options.height;
    question.sides = options.floor;
    question.ranks = options.ranks;
    question.probe = options.probe;
    words = report::to_json(forecast::estimate(comm, scene.input(), question));
  });
  return words;
}

std::string analyze(MPI_Comm world, const std::string& pack) {
  const comm::Comm comm(world);
  std::string words;
  library::together(comm, "", [&] { words = run::analyze(comm, pack); });
  return words;
}

Converted convert(MPI_Comm world, const std::string& pack, const std::string& format, const ConvertOptions& options) {
  const comm::Comm comm(world);
  Converted told;
  library::together(comm, "", [&] {
    if (options.copies[0] < 1 || options.copies[1] < 1) {
      throw Error(ExitCode::bad_input, "copies: give two counts from 1 on");
    }
    exporters::Converted done = exporters::convert_pack(comm, {.pack = pack,
                                                               .format = format,
                                                               .file = options.file,
                                                               .trim = trim_of(options.trim),
                                                               .cut = options.cut,
                                                               .copies = options.copies,
                                                               .force = options.force});
    told = {std::move(done.files), done.particles,    done.volume,
            std::move(done.cut),   done.cut_fraction, std::move(done.springs)};
  });
  return told;
}

}  // namespace packmpi
