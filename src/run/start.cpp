#include "run/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "base/error.hpp"
#include "base/log.hpp"
#include "input/read.hpp"
#include "observe/deepest.hpp"
#include "observe/measure.hpp"
#include "pack/pack.hpp"
#include "report/json_seal.hpp"
#include "start/fit.hpp"
#include "start/mixture.hpp"
#include "start/taken.hpp"

namespace packmpi::run {
namespace {

void add_particles(const pack::PackRows& rows, particles::Store& store) {
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const Vec3 spin = rows.spin.empty() ? Vec3{} : rows.spin[k];
    store.add(rows.id[k], rows.position[k], rows.radius[k], rows.velocity[k], spin);
  }
}

// Collective. What its contacts remember goes on if it is there and the law is the same; whether it does.
bool take_springs(const std::string& path, const input::Input& made, Bed& bed) {
  const scene::Features& wanted = bed.scene.features;
  if (!wanted.memory || start::feels_anew(made, bed.scene)) return false;
  const pack::Histories found = pack::histories_of(bed.comm, path, bed.scene);
  if (!found.any() || found.features.rolling != wanted.rolling) return false;
  bed.give(found);
  return true;
}

// As if its layers had settled.
void set_progress(Bed& bed, const std::vector<GlobalId>& first_ids, const std::string& how) {
  pack::Progress& at = bed.progress;
  at.count = bed.comm.sum(std::int64_t{bed.store.owned()});
  at.first_ids = first_ids;
  at.height = bed.height();
  at.energy_given = observe::energy_of(bed.comm, bed.store, bed.scene, 0, at.count);
  for (std::size_t k = 0; k < first_ids.size(); ++k) {
    report::LayerRow row;
    row.total = k + 1 < first_ids.size() ? first_ids[k + 1] : at.count;
    row.inserted = row.total - first_ids[k];
    row.stop_reason = how;
    at.layers.push_back(row);
  }
  at.layers.back().height = at.height;
  at.layers.back().top = bed.top();
}

// "particles 3 and 17 at (0.1, 0.2, 0.3) m", and the lines of a text file where they stand. Collective; the pair with
// the deepest overlap, or the particle deepest in a wall.
std::string worst_of(const Bed& bed, const start::TextRows& read) {
  const observe::Deepest worst =
      observe::deepest(bed.comm, bed.store, bed.scene, bed.neighborhood.pairs(), bed.neighborhood.walls());
  std::array<std::int64_t, 2> lines{0, 0};
  for (std::size_t k = 0; k < read.line.size(); ++k) {
    if (read.rows.id[k] == worst.first) lines[0] = read.line[k];
    if (read.rows.id[k] == worst.second) lines[1] = read.line[k];
  }
  bed.comm.max(std::span(lines));
  const bool wall = worst.second < 0;
  std::string words =
      wall ? fmt::format("particle {}", worst.first) : fmt::format("particles {} and {}", worst.first, worst.second);
  if (lines[0] > 0)
    words += wall ? fmt::format(" (line {})", lines[0]) : fmt::format(" (lines {} and {})", lines[0], lines[1]);
  const Vec3& x = worst.at;
  words += bed.scene.container.dimension == 2 ? fmt::format(" at ({:.6g}, {:.6g}) m", x[0], x[1])
                                              : fmt::format(" at ({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]);
  return words + (wall ? ", in a wall" : "");
}

// A number that has been passed already cannot be met.
void check_number(const Bed& bed) {
  const scene::Scene& scene = bed.scene;
  const std::int64_t count = scene.in.particles.count, there = bed.progress.count;
  if (count == 0 || there <= count) return;
  throw Error(ExitCode::bad_input, fmt::format("{}: particles.count: is {}, and {} has {}; raise it, or remove it",
                                               scene.in.file, count, scene.in.start->pack, there));
}

// The worst overlap. Throws if it is beyond what may be relaxed.
double check_overlaps(const Bed& bed, const start::TextRows& read) {
  const scene::Scene& scene = bed.scene;
  const observe::Validity valid = observe::validity(bed.comm, bed.store, scene);
  if (valid.outside > 0) {
    start::refuse(scene, fmt::format("start.pack: {} particles have centres outside the container, whose corner is at "
                                     "0 and whose floor is at {} = 0",
                                     valid.outside, "xyz"[scene.container.vertical()]));
  }
  const observe::Contacts touching =
      observe::contacts(bed.comm, bed.store, scene, bed.neighborhood.pairs(), bed.neighborhood.walls());
  const double worst = std::max(touching.max_overlap, touching.max_wall_penetration);
  if (worst > scene.in.start->overlap) {
    start::refuse(
        scene,
        fmt::format("start.pack: its deepest overlap is {:.3g} radii, of {}; start.overlap_limit is {:g}: raise that, "
                    "or give a pack that is at rest",
                    worst, worst_of(bed, read), scene.in.start->overlap));
  }
  return worst;
}

// Particles of a CSV or LAMMPS file, in one layer that has forgotten all else.
double take_text(Bed& bed, const std::string& path, start::Kind kind) {
  const scene::Scene& scene = bed.scene;
  start::TextRows read;
  comm::agree_on(bed.comm, [&] {
    start::check_one_material(scene);
    const int dimension = scene.container.dimension;
    read = kind == start::Kind::csv ? start::read_csv(path, dimension, bed.comm.rank(), bed.comm.size())
                                    : start::read_lammps(path, dimension, bed.comm.rank(), bed.comm.size());
    if (report::hexadecimal(start::digest_of_text(path)) != scene.in.start->digest)
      start::refuse(scene, "start.pack: was changed while it was read");
    start::fit_rows(scene, read);
  });
  add_particles(read.rows, bed.store);
  bed.neighborhood.rebuild(bed.store);  // to the owners of their columns
  bed.balance();
  set_progress(bed, {0}, start::reason_of_text(read));
  bed.progress.now = {.phase = pack::Phase::relaxation};
  return check_overlaps(bed, read);
}

double take_pack(Bed& bed, const std::string& path) {
  const scene::Scene& scene = bed.scene;
  const std::uint64_t seal = pack::check_pack(bed.comm, path);
  pack::PackSlice slice;
  input::Input made;
  comm::agree_on(bed.comm, [&] {
    if (report::hexadecimal(seal) != scene.in.start->digest)
      start::refuse(scene, "start.pack: was changed while it was read");
    slice = pack::read_slice(path, bed.comm.rank(), bed.comm.size());
    made = input::parse(slice.scene, path, {});
    start::check_fit(scene, made, slice);
  });
  add_particles(slice.rows, bed.store);
  const std::vector<GlobalId> first_ids = start::first_ids_of(bed.comm, slice.rows);
  if (scene.features.mixture) {
    bed.progress.mixing = start::mixing_of(bed.comm, scene, slice.rows, first_ids);
    bed.progress.first_ids = first_ids;
    bed.mark_components();
  }
  slice = {};
  const bool springs = take_springs(path, made, bed);
  bed.neighborhood.rebuild(bed.store);  // to the owners of their columns
  bed.balance();
  set_progress(bed, first_ids, start::reason_of_pack(springs));
  if (start::feels_anew(made, scene)) bed.progress.now = {.phase = pack::Phase::relaxation};
  return check_overlaps(bed, {});
}

}  // namespace

void take_over(Bed& bed) {
  const std::string path = start::path_of(bed.scene.in);
  start::Kind kind{};
  comm::agree_on(bed.comm, [&] { kind = start::kind_of(path); });
  const double worst = kind == start::Kind::pack ? take_pack(bed, path) : take_text(bed, path, kind);
  check_number(bed);
  log::info(fmt::format("start: {}; deepest overlap {:.2e} radii, height {:.4g} m",
                        start::taken_words(bed.scene, bed.progress), worst, bed.progress.height));
}

void check_start(const comm::Comm& comm, const scene::Scene& scene) {
  if (!scene.in.start) return;
  Bed bed(comm, scene);
  take_over(bed);
}

}  // namespace packmpi::run
