#include "run/analyze.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "disk/text_file.hpp"
#include "input/read.hpp"
#include "pack/pack.hpp"
#include "report/analysis.hpp"
#include "report/report.hpp"
#include "run/bed.hpp"
#include "scene/mixture.hpp"

namespace packmpi::run {
namespace {

constexpr double range_in_diameters = 2.5;
constexpr double shell_in_largest = 1.25;  // largest diameters: the first shell of the largest ones

// A scene with near pairs out to the analysis' range: a near field that is never evaluated.
scene::Scene reaching(scene::Scene scene, double& range) {
  range = std::max(range_in_diameters * 2.0 * scene.sizes.mean(), shell_in_largest * 2.0 * scene.sizes.largest());
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.container.lateral_axes()); ++axis) {
    // A periodic axis takes three interaction ranges.
    if (scene.container.periodic[axis])
      range = std::min(range, scene.container.size[axis] / (3.001 * scene.room()) - scene.skin);
  }
  scene.in.near_field = input::NearField{.alpha1 = 0.0, .beta1 = 0.0, .alpha2 = 0.0, .beta2 = 0.0, .cutoff = range};
  scene.reach = std::max(2.0 * scene.sizes.largest(), range);
  return scene;
}

scene::Scene reaching_scene(const pack::PackSlice& slice, const std::string& path, double& range) {
  scene::Scene scene = scene::build(input::parse(slice.scene, path, {}));
  confine::apply(slice.confined, scene.container);
  return reaching(std::move(scene), range);
}

// This rank's share of the rows, wherever their columns are.
void take_share(const pack::PackRows& rows, const scene::Scene& scene, particles::Store& store) {
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    store.add(rows.id[k], rows.position[k], rows.radius[k], rows.velocity[k], rows.spin.empty() ? Vec3{} : rows.spin[k],
              rows.component.empty() ? particles::Substance{}
                                     : scene::substance_of(scene.in, rows.component[k], rows.radius[k]));
  }
}

geometry::ColumnGrid analysis_columns(const scene::Scene& scene) {
  constexpr double pressed = 0.9;  // sides under servo come in, by less than that
  double range = 0.0;
  scene::Scene wide = reaching(scene, range);
  if (scene.in.confinement && scene.in.confinement->on_sides()) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(wide.container.lateral_axes()); ++a)
      wide.container.size[a] *= pressed;
  }
  return wide.columns();
}

/// Collective. What the contacts of the pack remember, to be laid down at the next rebuild; whether all that the law of
/// the scene needs is there.
bool give_springs(const std::string& path, Bed& bed) {
  const scene::Features& wanted = bed.scene.features;
  if (!wanted.memory) return true;
  const pack::Histories found = pack::histories_of(bed.comm, path, bed.scene);
  if (!found.any() || found.features.rolling != wanted.rolling) return false;
  bed.give(found);
  return true;
}

}  // namespace

std::int64_t most_ranks(const scene::Scene& scene) {
  const input::Decomposition kind = scene.in.parallel.decomposition;
  const std::int64_t most = scene::most_ranks(scene.columns(), kind);
  return scene.in.output.analysis ? std::min(most, scene::most_ranks(analysis_columns(scene), kind)) : most;
}

void check_ranks(const scene::Scene& scene, int ranks) {
  scene::check_ranks(scene.columns(), scene.in.parallel.decomposition, ranks);
  if (!scene.in.output.analysis) return;
  try {
    scene::check_ranks(analysis_columns(scene), scene.in.parallel.decomposition, ranks);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("output.analysis: its measures reach 2.5 diameters. {}; or analyze the pack "
                                          "afterwards, on fewer ranks",
                                          error.what()));
  }
}

std::string analyze(const comm::Comm& comm, const std::string& path) {
  const Occupation now("the analysis of the pack");
  const std::uint64_t seal = pack::check_pack(comm, path);
  pack::PackSlice slice;
  double range = 0.0;
  scene::Scene scene;
  comm::agree_on(comm, [&] {
    slice = pack::read_slice(path, comm.rank(), comm.size());
    scene = reaching_scene(slice, path, range);
    try {
      pack::check_in_scene(slice.rows, scene);
    } catch (const Error& error) {
      throw Error(error.code(), "cannot read " + path + ": " + error.what());
    }
  });
  Bed bed(comm, scene);
  take_share(slice.rows, scene, bed.store);
  const bool springs = give_springs(path, bed);
  bed.neighborhood.rebuild(bed.store);  // to the owners of their columns
  bed.balance();
  observe::Specimen specimen = observe::specimen_of(comm, scene, bed.store, bed.neighborhood, range);
  specimen.springs = springs;
  const observe::Analysis analysis = observe::analyse(specimen);
  const std::filesystem::path pack(path);
  disk::write_text(comm, (pack.parent_path() / (pack.stem().string() + ".analysis.json")).string(),
                   report::to_json(analysis, scene.container.dimension, seal));
  return report::to_table(analysis, scene.container.dimension);
}

}  // namespace packmpi::run
