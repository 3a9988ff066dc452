#include "run/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/log.hpp"
#include "input/read.hpp"
#include "observe/measure.hpp"
#include "pack/pack.hpp"
#include "report/json_seal.hpp"
#include "source/fit.hpp"

namespace packmpi::run {
namespace {

// Reasons to stop of layers that were taken over.
constexpr const char* without_springs = "taken over";
constexpr const char* with_springs = "taken over, with what contacts remember";

void add_particles(const pack::PackRows& rows, particles::Store& store) {
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const Vec3 spin = rows.spin.empty() ? Vec3{} : rows.spin[k];
    store.add(rows.id[k], rows.position[k], rows.radius[k], rows.velocity[k], spin);
  }
}

// The first id of each layer; one layer, if ids do not ascend with layers. Collective.
std::vector<GlobalId> first_ids_of(const comm::Comm& comm, const pack::PackRows& rows) {
  constexpr std::int32_t most = 1 << 20;
  const std::int32_t mine = rows.layer.empty() ? 0 : std::ranges::max(rows.layer);
  const auto layers = static_cast<std::size_t>(comm.max(std::int64_t{std::min(mine, most)})) + 1;
  std::vector<std::int64_t> last(layers, -1);  // ids, for the largest of all ranks
  std::vector<std::int64_t> first(layers,
                                  std::numeric_limits<std::int64_t>::min());  // negative: the least of all ranks
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const auto layer = static_cast<std::size_t>(std::min(rows.layer[k], most));
    first[layer] = std::max(first[layer], -rows.id[k]);
    last[layer] = std::max(last[layer], rows.id[k]);
  }
  comm.max(std::span(first));
  comm.max(std::span(last));
  std::vector<GlobalId> ids{0};
  for (std::size_t layer = 1; layer < layers; ++layer) {
    if (-first[layer] != last[layer - 1] + 1) return {0};
    ids.push_back(-first[layer]);
  }
  return ids;
}

// Collective. What its contacts remember goes on if it is there and the law is the same; whether it does.
bool take_springs(const std::string& path, const input::Input& made, Bed& bed) {
  const scene::Features& wanted = bed.scene.features;
  if (!wanted.memory || source::feels_anew(made, bed.scene)) return false;
  const pack::Histories found = pack::histories_of(bed.comm, path, bed.scene);
  if (!found.any() || found.features.rolling != wanted.rolling) return false;
  bed.give(found);
  return true;
}

// As if its layers had settled.
void set_progress(Bed& bed, const std::vector<GlobalId>& first_ids, bool springs) {
  pack::Progress& at = bed.progress;
  at.count = bed.comm.sum(std::int64_t{bed.store.owned()});
  at.first_ids = first_ids;
  at.height = bed.height();
  at.energy_given = observe::energy_of(bed.comm, bed.store, bed.scene, 0, at.count);
  for (std::size_t k = 0; k < first_ids.size(); ++k) {
    report::LayerRow row;
    row.total = k + 1 < first_ids.size() ? first_ids[k + 1] : at.count;
    row.inserted = row.total - first_ids[k];
    row.stop_reason = springs ? with_springs : without_springs;
    at.layers.push_back(row);
  }
  at.layers.back().height = at.height;
  at.layers.back().top = bed.top();
}

// The worst overlap. Throws if it is beyond what may be relaxed.
double check_overlaps(const Bed& bed) {
  const scene::Scene& scene = bed.scene;
  const observe::Validity valid = observe::validity(bed.comm, bed.store, scene);
  const observe::Contacts touching =
      observe::contacts(bed.comm, bed.store, scene, bed.neighborhood.pairs(), bed.neighborhood.walls());
  const double worst = std::max(touching.max_overlap, touching.max_wall_penetration);
  if (valid.outside > 0)
    source::refuse(scene, fmt::format("start.pack: {} particles are outside the container", valid.outside));
  if (worst > scene.in.start->overlap) {
    source::refuse(
        scene,
        fmt::format("start.pack: its deepest overlap is {:.3g} radii, beyond start.overlap_limit = {:g}; raise that, "
                    "or give a pack that is at rest",
                    worst, scene.in.start->overlap));
  }
  return worst;
}

}  // namespace

void take_over(Bed& bed) {
  const scene::Scene& scene = bed.scene;
  const std::string path = source::path_of(scene.in);
  const std::uint64_t seal = pack::check_pack(bed.comm, path);
  pack::PackSlice slice;
  input::Input made;
  comm::agree_on(bed.comm, [&] {
    if (report::hexadecimal(seal) != scene.in.start->digest)
      source::refuse(scene, "start.pack: was changed while it was read");
    slice = pack::read_slice(path, bed.comm.rank(), bed.comm.size());
    made = input::parse(slice.scene, path, {});
    source::check_fit(scene, made, slice);
  });
  add_particles(slice.rows, bed.store);
  const std::vector<GlobalId> first_ids = first_ids_of(bed.comm, slice.rows);
  slice = {};
  const bool springs = take_springs(path, made, bed);
  bed.neighborhood.rebuild(bed.store);  // to the owners of their columns
  bed.balance();
  set_progress(bed, first_ids, springs);
  const double worst = check_overlaps(bed);
  if (source::feels_anew(made, scene)) bed.progress.now = {.phase = pack::Phase::relaxation};
  log::info(fmt::format("start: {}; deepest overlap {:.2e} radii, height {:.4g} m", taken_words(scene, bed.progress),
                        worst, bed.progress.height));
}

std::string taken_words(const scene::Scene& scene, const pack::Progress& progress) {
  if (!scene.in.start) return "";
  std::int64_t layers = 0, particles = 0;
  bool springs = false;
  for (const report::LayerRow& row : progress.layers) {
    if (!is_taken_over(row)) continue;
    ++layers;
    particles = row.total;
    springs = row.stop_reason == with_springs;
  }
  return fmt::format(
      "{} (digest {}): {} particles in {} layer{} taken over, with positions, radii, velocities{}{}; not taken over: "
      "{}time and counters",
      scene.in.start->pack, scene.in.start->digest, particles, layers, layers == 1 ? "" : "s",
      scene.features.rotation ? ", spins" : "", springs ? ", what contacts remember" : "",
      lacks_springs(scene, progress) ? "what contacts remember, " : "");
}

bool is_taken_over(const report::LayerRow& row) { return row.stop_reason.starts_with(without_springs); }

bool lacks_springs(const scene::Scene& scene, const pack::Progress& progress) {
  if (!scene.features.memory) return false;
  return std::ranges::any_of(progress.layers,
                             [](const report::LayerRow& row) { return row.stop_reason == without_springs; });
}

}  // namespace packmpi::run
