#include "pack/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>

#include "base/digest.hpp"
#include "base/memory.hpp"
#include "disk/scatter.hpp"
#include "disk/whole_file.hpp"
#include "pack/histories.hpp"
#include "pack/run_state.hpp"

namespace packmpi::pack {
namespace {

constexpr std::size_t longest_record = 12;  // doubles

struct RecordRow {
  GlobalId id;
  std::array<double, longest_record> values;
};

using Stores = std::span<const particles::Store* const>;

std::vector<RecordRow> rows_here(Stores stores, const disk::IdPiece& piece) {
  std::vector<RecordRow> rows;
  rows.reserve(static_cast<std::size_t>(piece.length));
  for (const particles::Store* store : stores) {
    for (LocalIndex i = 0; i < store->owned(); ++i) {
      const GlobalId id = store->ids()[static_cast<std::size_t>(i)];
      if (!piece.has(id)) continue;
      RecordRow row{id, {}};
      std::copy_n(store->record(i), store->layout().used_doubles(), row.values.begin());
      rows.push_back(row);
    }
  }
  return rows;
}

std::uint64_t digest_of(const comm::Comm& comm, Stores stores) {
  std::uint64_t mine = 0;
  for (const particles::Store* store : stores) mine += particles::digest(*store);
  return static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(mine)));  // mod 2^64
}

/// What is known of contacts before any of them is on its way.
struct Counted {
  disk::h5::Slab slab{};     ///< of this rank in the file
  std::uint64_t digest = 0;  ///< of all, whatever their order
};

/// Collective.
Counted count_histories(const comm::Comm& comm, const disk::IdBlocks& blocks, const HistoriesHere& histories) {
  std::map<Rank, std::int64_t> counts;
  std::uint64_t digests = 0;
  histories.each([&](const HistoryRow& row) {
    ++counts[blocks.owner(row.holder)];
    digests += digest(row, histories.features);
  });
  return {.slab = disk::slab_of(comm, disk::count_incoming(comm, counts)),
          .digest = static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(digests)))};  // mod 2^64
}

/// `width` doubles of each row's values from `begin` on.
template <class Row>
disk::h5::Column values_column(const std::string& path, std::string_view unit, const disk::h5::Slab& slab,
                               const std::vector<Row>& rows, int begin, int width) {
  const auto from = static_cast<std::size_t>(begin);
  const auto wide = static_cast<std::size_t>(width);
  auto bytes = [&rows, from, wide](std::size_t first, std::size_t count) {
    std::vector<std::byte> buffer(count * wide * sizeof(double));
    std::byte* out = buffer.data();
    for (std::size_t k = first; k < first + count; ++k, out += wide * sizeof(double)) {
      std::memcpy(out, rows[k].values.data() + from, wide * sizeof(double));
    }
    return buffer;
  };
  return {path,
          std::string(unit),
          disk::h5::Handle(H5Tcopy(disk::h5::type_of<double>()), H5Tclose, "copy a type"),
          wide,
          slab,
          [&rows] { return rows.size(); },
          bytes};
}

void add_particles(const disk::h5::Slab& slab, const std::vector<RecordRow>& rows, const particles::Layout& layout,
                   std::vector<disk::h5::Column>& plan) {
  const auto add = [&](const char* name, const char* unit, int begin, int width) {
    plan.push_back(values_column(std::string("/particles/") + name, unit, slab, rows, begin, width));
  };
  plan.push_back(disk::h5::make_column<std::int64_t>("/particles/id", "", slab, rows,
                                                     [](const RecordRow& row) { return row.id; }));
  add("position", "m", layout.position, layout.dimension);
  add("radius", "m", layout.radius, 1);
  add("velocity", "m/s", layout.velocity, layout.dimension);
  if (layout.rotation) add("surface_speed", "m/s", layout.spin, layout.spin_components());
}

void add_histories(const disk::h5::Slab& slab, const Histories& histories, std::vector<disk::h5::Column>& plan) {
  if (!histories.any()) return;
  const std::vector<HistoryRow>& rows = histories.rows;
  plan.push_back(disk::h5::make_column<std::int64_t>("/contacts/holder", "", slab, rows,
                                                     [](const HistoryRow& row) { return row.holder; }));
  plan.push_back(disk::h5::make_column<std::int64_t>("/contacts/other", "", slab, rows,
                                                     [](const HistoryRow& row) { return row.other; }));
  int begin = 0;
  for (const scene::Storing& what : scene::storings(histories.features)) {
    plan.push_back(values_column("/contacts/" + std::string(what.name), what.unit, slab, rows, begin, what.components));
    begin += what.components;
  }
}

/// Digests of what the rows of a file must be, whatever their order.
struct Digests {
  std::uint64_t particles = 0;
  std::optional<std::uint64_t> contacts;  ///< none: no contacts in the file
};

/// Collective. The particles of a piece, to the ranks that write them.
std::vector<RecordRow> bring(const comm::Comm& comm, const disk::IdPiece& piece, Stores stores) {
  std::vector<RecordRow> rows = scatter(comm, piece, rows_here(stores, piece), &RecordRow::id);
  comm::agree_on(comm, [&] {
    const bool all = static_cast<GlobalId>(rows.size()) == piece.end(comm.rank()) - piece.begin(comm.rank());
    const auto out_of_order = [](const RecordRow& a, const RecordRow& b) { return a.id >= b.id; };
    if (!all || std::ranges::adjacent_find(rows, out_of_order) != rows.end()) {
      throw Error(ExitCode::numerical_failure, "particles were lost; no checkpoint is written");
    }
  });
  return rows;
}

/// Collective. What their contacts remember: by holder, and of a holder by the other end.
std::vector<HistoryRow> bring(const comm::Comm& comm, const disk::IdPiece& piece, const HistoriesHere& histories) {
  std::vector<HistoryRow> rows;
  if (!histories.any()) return rows;
  histories.each([&](const HistoryRow& row) {
    if (piece.has(row.holder)) rows.push_back(row);
  });
  rows = scatter(comm, piece, std::move(rows), &HistoryRow::holder);
  sort_by_ends(rows);
  return rows;
}

void write_bytes(hid_t file, const std::string& path, const std::string& text) {
  disk::h5::write_small(file, path, "", std::vector<std::uint8_t>(text.begin(), text.end()));
}

// All of the file but the rows of `plan`.
void write_frame(hid_t file, const std::vector<disk::h5::Column>& plan, const RunState& state, const Digests& digests) {
  const std::string text = to_text(state);
  disk::h5::set_fixed_attribute(file, "format", "packmpi-checkpoint");
  disk::h5::set_attribute(file, "format_version", checkpoint_version);
  disk::h5::set_attribute(file, "particle_digest", digests.particles);
  if (digests.contacts) disk::h5::set_attribute(file, "contact_digest", *digests.contacts);
  disk::h5::set_attribute(file, "text_digest", fnv_add(fnv_add(fnv_start, text), state.effective_input));
  (void)disk::h5::create_group(file, "/particles");
  if (digests.contacts) (void)disk::h5::create_group(file, "/contacts");
  write_bytes(file, "/state", text);
  write_bytes(file, "/effective_input", state.effective_input);
  for (const disk::h5::Column& column : plan) disk::h5::create_dataset(file, column);
}

}  // namespace

std::int64_t particles_at_a_time(std::int64_t particles, int ranks) {
  return disk::IdPieces{{particles, ranks}, rows_at_a_time}.length();
}

void write_checkpoint(const comm::Comm& comm, const std::string& path, std::span<const particles::Store* const> stores,
                      const RunState& state, const HistoriesHere& histories, std::int64_t piece) {
  const Occupation now("the checkpoint on its way to the file");
  const disk::h5::Quiet quiet;
  const disk::IdBlocks blocks{state.progress.count, comm.size()};
  const disk::h5::Slab slab = disk::slab_of(comm, blocks.begin(comm.rank() + 1) - blocks.begin(comm.rank()));
  Digests digests{.particles = digest_of(comm, stores), .contacts = {}};
  Counted contacts;
  if (histories.any()) {
    contacts = count_histories(comm, blocks, histories);
    digests.contacts = contacts.digest;
  }
  std::vector<RecordRow> rows;
  Histories touching{.features = histories.features, .rows = {}};
  std::vector<disk::h5::Column> plan;
  add_particles(slab, rows, stores.front()->layout(), plan);
  add_histories(contacts.slab, touching, plan);
  const disk::IdPieces pieces{blocks, piece};
  const disk::Pieces supply{.count = pieces.count(), .bring = [&](std::int64_t k) {
                              rows = bring(comm, pieces.piece(k), stores);
                              touching.rows = bring(comm, pieces.piece(k), histories);
                            }};
  disk::write_whole_file(
      comm, path, plan, [&](hid_t file) { write_frame(file, plan, state, digests); }, supply);
}

std::int64_t checkpoint_bytes(const particles::Layout& layout, const RunState& state, const scene::Features& features,
                              std::int64_t contacts) {
  const disk::h5::Slab slab{static_cast<hsize_t>(state.progress.count), 0, 0};
  const std::vector<RecordRow> none;
  const Histories histories{.features = features, .rows = {}};
  const Digests digests{.particles = 0, .contacts = histories.any() ? std::optional<std::uint64_t>(0) : std::nullopt};
  std::vector<disk::h5::Column> plan;
  add_particles(slab, none, layout, plan);
  add_histories({static_cast<hsize_t>(contacts), 0, 0}, histories, plan);
  return disk::whole_file_bytes(plan, [&](hid_t file) { write_frame(file, plan, state, digests); });
}

}  // namespace packmpi::pack
