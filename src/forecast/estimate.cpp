#include "forecast/estimate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "confine/servo.hpp"
#include "forecast/advice.hpp"
#include "forecast/probe.hpp"
#include "forecast/solve.hpp"
#include "geometry/volume.hpp"
#include "input/time_step.hpp"
#include "pack/checkpoint.hpp"
#include "pack/pack.hpp"
#include "report/fields.hpp"
#include "run/analyze.hpp"
#include "run/record.hpp"
#include "run/search.hpp"
#include "run/settle.hpp"
#include "scene/expectation.hpp"
#include "scene/ownership.hpp"
#include "scene/pair_channels.hpp"
#include "tables/units.hpp"

namespace packmpi::forecast {
namespace {

constexpr double probe_seconds = 1.0;
constexpr double step_row_bytes = 190.0;  // of NAME.steps.csv, about (doc/estimate.md)
// Memory of a rank (doc/estimate.md): the program and its libraries; slack of arrays that grow; what lists add to a
// particle; a row on its way to a file, three times.
constexpr double program_bytes = 51e6;
constexpr double growth = 1.1;
constexpr std::array<double, 2> pairs_a_particle{3.3, 4.4};  // listed, of discs, of spheres
constexpr double pair_bytes = 2.0 * sizeof(LocalIndex);
constexpr std::array<double, 2> contacts_of_one{4.5, 5.2};  // of a disc, of a sphere
constexpr double row_bytes = 350.0, contact_row_bytes = 250.0;

// The share of copies that a rank of `ranks` holds beside its own particles.
double ghost_share(const scene::Scene& scene, int ranks) {
  const auto side = [&](std::size_t axis, int parts) {  // copies along one axis, by the part's own width
    if (parts == 1) return 0.0;
    const double faces = parts == 2 && !scene.container.periodic[axis] ? 1.0 : 2.0;
    return std::min(1.0 * (parts - 1), faces * scene.list_range() * parts / scene.container.size[axis]);
  };
  const std::size_t longer =
      scene.container.dimension == 3 && scene.container.size[1] > scene.container.size[0] ? 1 : 0;
  if (scene.in.parallel.decomposition == input::Decomposition::slab || scene.container.dimension == 2)
    return side(longer, ranks);
  double least = side(longer, ranks);
  for (int parts = 2; parts < ranks; ++parts) {
    if (ranks % parts != 0) continue;
    const double x = side(longer, parts);
    const double y = side(1 - longer, ranks / parts);
    least = std::min(least, (1.0 + x) * (1.0 + y) - 1.0);
  }
  return least;
}

// Bytes of a particle on its rank, and of a copy.
double own_bytes(const scene::Scene& scene) {
  const particles::Layout layout = scene.features.layout();
  const int axes = scene.container.dimension;
  const double stored = static_cast<double>(layout.record_bytes()) + sizeof(GlobalId);
  const double remembered =
      sizeof(double) * (axes + 2.0);  // where it was at the last rebuild, how far it reaches, its contacts
  return growth * (stored + remembered);
}
double list_bytes(const scene::Scene& scene) {
  const double pairs = pairs_a_particle[static_cast<std::size_t>(scene.container.dimension - 2)];
  const int stored = scene::stored_doubles(scene.features);
  if (stored == 0) return growth * pair_bytes * pairs;
  // What contacts remember, and once more, with two words each, where they touch, while the lists are made anew.
  constexpr double touching = 0.6;
  return pairs * (growth * pair_bytes + sizeof(double) * (stored + touching * (stored + 2)));
}

// Of a rank with `own` particles, all of them moving, while lists are made.
double settling_bytes(const scene::Scene& scene, double own, double ghosts) {
  return program_bytes + own * ((1.0 + ghosts) * own_bytes(scene) + list_bytes(scene));
}

// What a file takes beside, a piece of it at a time.
double writing_bytes(const scene::Scene& scene, std::int64_t particles, int ranks) {
  const double contacts = contacts_of_one[static_cast<std::size_t>(scene.container.dimension - 2)] / 2.0;
  const bool written = scene.features.memory || scene.in.output.contacts;
  const double own = static_cast<double>(particles) / ranks;
  return std::min(own, static_cast<double>(pack::particles_at_a_time(particles, ranks))) *
         (row_bytes + (written ? contact_row_bytes * contacts : 0.0));
}

// A row as a run writes it: its numbers have all their digits.
report::LayerRow some_row() {
  constexpr double digits = 0.12345678901234567;
  return {.inserted = 1000,
          .total = 1000,
          .attempts = 1000,
          .target_fraction = 0.25,
          .achieved_fraction = digits,
          .region_bottom = digits,
          .height = digits,
          .top = digits,
          .duration = digits,
          .steps = 1000,
          .kinetic_per_mgd = digits,
          .max_overlap = digits,
          .coordination = digits,
          .stop_reason = "duration"};
}

/// Contacts of a full box. Of a wall seven tenths are covered by the shadows of the particles that touch it, about as
/// many as of a random loose layer.
pack::ContactCounts expected_contacts(const scene::Scene& scene, std::int64_t particles) {
  const geometry::Container& container = scene.container;
  const double touching = contacts_of_one[static_cast<std::size_t>(container.dimension - 2)];
  const double walls = container.mean_area() + container.wall_area(container.height());
  const double r = scene.sizes.mean();
  const double shadow = container.dimension == 3 ? geometry::volume(2, r) : 2.0 * r;
  return {.pairs = std::llround(0.5 * touching * static_cast<double>(particles)),
          .walls = std::llround(0.7 * walls / shadow),
          .features = scene.features};
}

void add_files(const comm::Comm& comm, const scene::Scene& scene, report::Estimate& e) {
  const auto rows = static_cast<std::size_t>(e.layers.value);
  report::RunRecord record = run::targets_of(comm, scene);
  record.stop_reason = "height";
  record.layers.assign(rows, some_row());
  const pack::ContactCounts contacts = expected_contacts(scene, e.particles.value);
  e.pack_bytes =
      pack::pack_bytes(record, scene.in.dynamics.rotation, e.particles.value,
                       scene.in.output.contacts ? std::optional(contacts) : std::nullopt, observe::map_columns(scene));
  pack::RunState state;
  state.effective_input = scene.in.effective;
  state.version = record.version;
  state.git = record.git;
  state.dimension = record.dimension;
  state.rotation = scene.in.dynamics.rotation;
  state.progress.count = e.particles.value;
  state.progress.layers = record.layers;
  state.progress.now.row = some_row();
  for (std::int64_t layer = 0; layer < e.layers.value; ++layer) state.progress.first_ids.push_back(layer * e.a_layer);
  e.checkpoint_bytes =
      pack::checkpoint_bytes(scene.features.layout(), state, scene.features, contacts.pairs + contacts.walls);
  const std::int64_t logged = e.steps / scene::steps_a_row(scene.in.output, scene.settling.time_step);
  e.step_log_bytes = std::llround(step_row_bytes * static_cast<double>(std::max<std::int64_t>(1, logged)));
}

void add_counts(const scene::Scene& scene, const scene::BedFraction& fraction, report::Estimate& e) {
  const auto filling = [&](double shift) {
    return scene::expected_filling(scene, std::clamp(fraction.value + shift, 1e-3, 1.0));
  };
  const scene::Filling most = filling(fraction.error), least = filling(-fraction.error), usual = filling(0.0);
  e.a_layer = scene::particles_a_layer(scene);
  e.layers = {usual.layers, least.layers, most.layers};
  const auto by_chance = [&](std::int64_t count) {  // two standard deviations
    return std::llround(2.0 * scene::deviation_of_count(scene, static_cast<double>(count)));
  };
  e.height = usual.height;
  const auto [fewest, many] = std::minmax({usual.particles, least.particles, most.particles});
  e.particles = {usual.particles, fewest, many};  // a denser bed may end a layer earlier
  if (scene.in.particles.count > 0) return;       // exactly
  e.particles.least = std::max<std::int64_t>(1, e.particles.least - by_chance(e.particles.least) - least.uncertainty);
  e.particles.most += by_chance(e.particles.most) + most.uncertainty;
}

// Steps of the final stage: its own, or as many more as beds with memory took until they were at rest, 0.9 to 3.3 falls
// (doc/data/presets.csv); none that waits takes longer than it may.
std::int64_t final_steps(const scene::Scene& scene) {
  constexpr double falls = 1.7, wide = 5.0, falls_if_wide = 10.0;
  if (!(scene.relaxation > 0.0)) return 0;
  const std::int64_t own = run::steps_of(scene, run::Part::relaxation);
  if (!(scene.wait > 0.0) || !scene.features.memory || !(scene.in.jamming.gravity > 0.0)) return own;
  const double usual = (scene.sizes.ratio() > wide ? falls_if_wide : falls) * input::fall_time(scene.in);
  return std::clamp(scene::steps_in(usual, scene.time_step), own, own + scene::steps_in(scene.wait, scene.time_step));
}

void add_steps(const scene::Scene& scene, report::Estimate& e) {
  const std::int64_t layer = run::steps_of(scene, run::Part::layer);
  e.relaxation_steps = final_steps(scene);
  e.steps = e.layers.value * layer + e.relaxation_steps;
  e.duration = static_cast<double>(e.layers.value * layer) * scene.settling.time_step +
               static_cast<double>(e.relaxation_steps) * scene.time_step;
  e.particle_steps = particle_steps_of(scene, e.layers.value, e.a_layer);
  const double each = scene.in.particles.density * geometry::volume(3, 1.0) * scene.sizes.curve().moment(3);
  e.confinement_steps = confine::expected_steps(scene, e.height, each * static_cast<double>(e.particles.value));
  e.steps += e.confinement_steps;
  e.duration += static_cast<double>(e.confinement_steps) * scene.confining_step;
  e.particle_steps += e.confinement_steps * e.particles.value;
  e.at_most = scene.in.dynamics.stop == input::StopRule::settled;
}

void add_ranks(const scene::Scene& scene, int ranks, report::Estimate& e) {
  e.ranks = ranks;
  e.most_ranks = run::most_ranks(scene);
  run::check_ranks(scene, ranks);
  e.ghosts = ghost_share(scene, ranks);
  const double own = static_cast<double>(e.particles.value) / ranks;
  const double settling = settling_bytes(scene, own, e.ghosts);
  e.settling_bytes = std::llround(settling);
  e.writing_bytes = std::llround(settling + writing_bytes(scene, e.particles.value, ranks));
}

// Of a sample whose density holds under stress.
std::int64_t steps_under_stress(const scene::Scene& sample) {
  if (sample.in.target->state != input::TargetState::confined) return 0;
  const scene::Filling filling = scene::expected_filling(sample, scene::expected_fraction(sample).value);
  const double each = sample.in.particles.density * geometry::volume(3, 1.0) * sample.sizes.curve().moment(3);
  return confine::expected_steps(sample, filling.height, each * static_cast<double>(filling.particles));
}

// As if one after the other: ranks share only the first ones.
void add_search(const scene::Scene& scene, report::Estimate& e) {
  if (!scene.in.target) return;
  const control::Sample sample = control::sample_of(scene);
  const std::int64_t a_layer = scene::particles_a_layer(sample.scene);
  const std::int64_t layers = scene::expected_layers(sample.scene, scene::expected_fraction(sample.scene).value);
  const std::int64_t extremes = scene.in.target->relative_density ? 2 * run::seeds_of_extremes : 0;
  e.search = report::SearchCost{.samples = run::most_trials(sample) + extremes,
                                .particles = layers * a_layer,
                                .particle_steps = particle_steps_of(sample.scene, layers, a_layer) +
                                                  layers * a_layer * steps_under_stress(sample.scene)};
}

void add_probe(const comm::Comm& comm, const scene::Scene& scene, report::Estimate& e) {
  report::Probe got;
  comm::agree_on(comm, [&] { got = probe(scene, probe_seconds); });
  got.particle_steps_per_second = comm.min(got.particle_steps_per_second);
  got.insertions_per_second = comm.min(got.insertions_per_second);
  e.probe = got;
  e.seconds = static_cast<double>(e.particles.value) / (got.insertions_per_second * e.ranks);
  if (e.particle_steps > 0)
    e.seconds += static_cast<double>(e.particle_steps) / (got.particle_steps_per_second * e.ranks);
  if (e.search)
    e.seconds += static_cast<double>(e.search->samples * e.search->particle_steps) / got.particle_steps_per_second;
}

}  // namespace

std::int64_t particle_steps_of(const scene::Scene& scene, std::int64_t layers, std::int64_t a_layer) {
  const std::int64_t window = scene.in.dynamics.window;
  const std::int64_t growing = window > 0 ? std::min(layers, window) : layers;  // layers in which more and more move
  const std::int64_t moved = growing * (growing + 1) / 2 + growing * (layers - growing);
  return a_layer * (moved * run::steps_of(scene, run::Part::layer) + layers * final_steps(scene));
}

std::int64_t memory_a_rank(const scene::Scene& scene, int ranks) {
  report::Estimate e;
  add_counts(scene, scene::expected_fraction(scene), e);
  const double own = static_cast<double>(e.particles.value) / ranks;
  return std::llround(settling_bytes(scene, own, ghost_share(scene, ranks)) +
                      writing_bytes(scene, e.particles.value, ranks));
}

namespace {

report::Estimate estimate_of(const comm::Comm& comm, const Source& source, const Question& question) {
  Unknown unknown{};
  const scene::Scene scene = solved(source, question, unknown);
  constexpr std::array<const char*, 3> names{"particles", "height", "floor"};
  const scene::BedFraction fraction = fraction_of(scene, question);
  report::Estimate e;
  e.scene_file = scene.in.file;
  e.found = names.at(static_cast<std::size_t>(unknown));
  e.round = scene.container.shape == geometry::Shape::cylinder;
  e.other = !has_size(scene.container);
  e.size = scene.in.container.size;
  e.layer_thickness = scene.in.layers.thickness;
  e.thickness_changed = unknown == Unknown::height && fits_thickness(scene);
  e.fraction = fraction.value;
  e.fraction_error = fraction.error;
  e.fraction_given = question.fraction.has_value();
  add_counts(scene, fraction, e);
  add_steps(scene, e);
  add_search(scene, e);
  add_ranks(scene, question.ranks > 0 ? question.ranks : comm.size(), e);
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0) add_files(comm, scene, e);
  });
  std::array<std::int64_t, 3> bytes{e.pack_bytes, e.checkpoint_bytes, e.step_log_bytes};
  comm.max(bytes);
  e.pack_bytes = bytes[0], e.checkpoint_bytes = bytes[1], e.step_log_bytes = bytes[2];
  e.warnings = warnings_of(scene);
  if (scene.in.start) e.warnings.emplace_back("[start] is left out: this is of the scene from its floor on");
  if (question.probe) add_probe(comm, scene, e);
  return e;
}

}  // namespace

report::Estimate estimate(const comm::Comm& comm, const std::string& path, const input::Overrides& overrides,
                          const Question& question) {
  const auto source = [&](const std::vector<std::string>& sets) {
    input::Overrides all = overrides;
    all.set.insert(all.set.end(), sets.begin(), sets.end());
    return input::read(comm, path, all);
  };
  return estimate_of(comm, source, question);
}

report::Estimate estimate(const comm::Comm& comm, const input::Input& in, const Question& question) {
  const auto source = [&](const std::vector<std::string>& sets) { return input::parse(in.effective, in.file, {sets}); };
  return estimate_of(comm, source, question);
}

}  // namespace packmpi::forecast
