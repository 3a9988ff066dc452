#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "base/digest.hpp"
#include "disk/scatter.hpp"
#include "disk/sealed_file.hpp"
#include "pack/checkpoint.hpp"
#include "pack/former_names.hpp"
#include "pack/histories.hpp"
#include "pack/run_state.hpp"

namespace packmpi::pack {
namespace {

constexpr std::int64_t renamed_version = 3;  // from which on names are those of today

[[noreturn]] void refuse_checkpoint(const std::string& words) { throw Error(ExitCode::bad_checkpoint, words); }

// The particles are held to their own digest.
disk::SealedFile open_file(const std::string& path) {
  if (!std::filesystem::exists(path)) refuse_checkpoint("there is no such file");
  disk::SealedFile file(path);
  if (!file.has_attribute("/", "format_version") || !file.has_attribute("/", "text_digest")) {
    refuse_checkpoint("it is not a checkpoint of packmpi");
  }
  const auto version = file.number<std::int64_t>("/", "format_version");
  if (version < oldest_checkpoint_version || version > checkpoint_version) {
    refuse_checkpoint(
        fmt::format("it has format version {}, and this packmpi reads {} to {}: go on with the packmpi "
                    "that wrote it, or begin anew",
                    version, oldest_checkpoint_version, checkpoint_version));
  }
  return file;
}

RunState state_in(const disk::SealedFile& file) {
  const std::string text = file.bytes("/state");
  const std::string scene = file.bytes("/effective_input");
  if (fnv_add(fnv_add(fnv_start, text), scene) != file.number<std::uint64_t>("/", "text_digest")) {
    refuse_checkpoint("the digest of its state and scene is wrong: the file is damaged");
  }
  const bool former = file.number<std::int64_t>("/", "format_version") < renamed_version;
  RunState state = former ? former_state_of(state_in_present_names(text)) : state_of(text);
  state.effective_input = former ? scene_in_present_names(scene) : scene;
  const Progress& p = state.progress;
  const control::Filling& f = p.filling;
  const bool filling_valid =
      !f.on || (f.layer_knobs.size() == p.first_ids.size() && f.layer_surfaces.size() == p.layers.size() &&
                f.layer_fractions.size() == p.layers.size() && f.knobs.size() == f.filled.size() &&
                f.knobs.size() == f.relaxed.size());
  const control::Mixing& m = p.mixing;
  const bool mixing_valid = !m.on || (m.strata.size() == p.first_ids.size() && !m.drawn.empty() &&
                                      m.counts.size() == m.drawn.size() * m.strata.size() &&
                                      m.units.size() == m.drawn.size() && m.wanted.size() == m.drawn.size());
  const bool valid = filling_valid && mixing_valid && p.count >= 0 && p.steps >= 0 && p.now.done >= 0 &&
                     state.dimension >= 2 && state.dimension <= 3 && std::ranges::is_sorted(p.first_ids) &&
                     p.first_ids.size() == p.layers.size() + (p.now.phase == Phase::settling ? 1 : 0);
  if (!valid) refuse_checkpoint("its state contradicts itself");
  return state;
}

/// Whether these numbers can be a particle's, wherever it is.
bool is_particle(const particles::Layout& layout, const std::vector<double>& record) {
  const double radius = record[static_cast<std::size_t>(layout.radius)];
  const auto is_finite = [](double x) { return std::isfinite(x); };
  return radius > 0.0 && std::ranges::all_of(record, is_finite);
}

/// Rows [begin, end) into the store.
void read_particles(const disk::SealedFile& file, const disk::Range& range, particles::Store& store) {
  const particles::Layout& layout = store.layout();
  const auto count = static_cast<std::size_t>(range.count);
  const auto read = [&](const char* name, int width) {
    return file.numbers<double>(std::string("/particles/") + name, range, static_cast<std::size_t>(width));
  };
  const auto id = file.numbers<std::int64_t>("/particles/id", range, 1);
  const auto position = read("position", layout.dimension);
  const auto radius = read("radius", 1);
  const auto velocity = read("velocity", layout.dimension);
  const std::vector<double> spin = layout.rotation ? read("surface_speed", layout.spin_components()) : radius;
  std::vector<double> record(static_cast<std::size_t>(layout.stride));
  const auto copy = [&record](const std::vector<double>& from, std::size_t row, int width, int to) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(row) * width, width, record.begin() + to);
  };
  for (std::size_t k = 0; k < count; ++k) {
    copy(position, k, layout.dimension, layout.position);
    copy(radius, k, 1, layout.radius);
    copy(velocity, k, layout.dimension, layout.velocity);
    if (layout.rotation) copy(spin, k, layout.spin_components(), layout.spin);
    record[static_cast<std::size_t>(layout.curvature)] = 1.0 / radius[k];  // as Store::add() makes it
    if (!is_particle(layout, record)) refuse_checkpoint(fmt::format("particle {} has numbers that cannot be", id[k]));
    store.add_record(id[k], record.data());
  }
}

/// Runs `action`; whatever is thrown becomes "PATH: words" with the code of an unusable checkpoint.
template <class Action>
void explained(const std::string& path, Action&& action) {
  try {
    action();
  } catch (const std::exception& error) {  // bad_alloc too: a damaged size
    throw Error(ExitCode::bad_checkpoint, fmt::format("checkpoint {}: {}", path, error.what()));
  }
}

/// Digests that the file says of its rows.
struct SaidDigests {
  std::uint64_t particles = 0, contacts = 0;
};

/// Collective. `mine` is of this rank's rows of `what`.
void expect_digest(const comm::Comm& comm, const std::string& path, std::string_view what, std::uint64_t mine,
                   std::uint64_t expected) {
  if (static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(mine))) == expected) return;
  comm::fail_together(comm, ExitCode::bad_checkpoint,
                      fmt::format("checkpoint {}: the digest of its {} is wrong: the file is damaged", path, what));
}

/// Collective. Each to the rank that has its holder, of so many `particles`.
void bring_to_holders(const comm::Comm& comm, const std::string& path, GlobalId particles,
                      std::vector<HistoryRow>& rows) {
  rows = disk::scatter(comm, disk::IdBlocks{particles, comm.size()}, std::move(rows), &HistoryRow::holder);
  sort_by_ends(rows);
  comm::agree_on(comm, [&] { explained(path, [&] { check_once(rows); }); });
}

}  // namespace

RunState read_state(const std::string& path) {
  const disk::h5::Quiet quiet;
  RunState state;
  explained(path, [&] { state = state_in(open_file(path)); });
  return state;
}

RunState read_checkpoint(const comm::Comm& comm, const std::string& path, particles::Store& store,
                         Histories* histories) {
  const disk::h5::Quiet quiet;
  RunState state;
  SaidDigests expected;
  Histories found;
  comm::agree_on(comm, [&] {
    explained(path, [&] {
      const disk::SealedFile file = open_file(path);
      state = state_in(file);
      expected.particles = file.number<std::uint64_t>("/", "particle_digest");
      if (state.dimension != store.layout().dimension || state.rotation != store.layout().rotation) {
        refuse_checkpoint("it is of another dimension, or with and without rotation");
      }
      const disk::IdBlocks blocks{state.progress.count, comm.size()};
      const GlobalId begin = blocks.begin(comm.rank());
      read_particles(file, {state.progress.count, begin, blocks.begin(comm.rank() + 1) - begin}, store);
      found.features = stored_in(file, state.dimension);
      if (!found.any()) return;
      expected.contacts = file.number<std::uint64_t>("/", "contact_digest");
      found.rows = read_histories(file, comm, found.features, state.progress.count);
    });
  });
  expect_digest(comm, path, "particles", particles::digest(store), expected.particles);
  if (found.any()) {
    std::uint64_t mine = 0;
    for (const HistoryRow& row : found.rows) mine += digest(row, found.features);
    expect_digest(comm, path, "contacts", mine, expected.contacts);
    bring_to_holders(comm, path, state.progress.count, found.rows);
  }
  if (histories != nullptr) *histories = std::move(found);
  return state;
}

}  // namespace packmpi::pack
