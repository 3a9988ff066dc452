#include "pack/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/fnv.hpp"
#include "base/memory.hpp"
#include "disk/scatter.hpp"
#include "disk/whole_file.hpp"
#include "pack/run_state.hpp"

namespace packmpi::pack {
namespace {

constexpr std::size_t longest_record = 12;  // doubles

struct RecordRow {
  GlobalId id;
  std::array<double, longest_record> record;
};

using Stores = std::span<const particles::Store* const>;

std::vector<RecordRow> rows_here(Stores stores) {
  std::size_t count = 0;
  for (const particles::Store* store : stores) count += static_cast<std::size_t>(store->owned());
  std::vector<RecordRow> rows;
  rows.reserve(count);
  for (const particles::Store* store : stores) {
    for (LocalIndex i = 0; i < store->owned(); ++i) {
      RecordRow row{store->ids()[static_cast<std::size_t>(i)], {}};
      std::copy_n(store->record(i), store->layout().used_doubles(), row.record.begin());
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

/// `width` doubles of each record from `begin` on.
disk::h5::Column record_column(const std::string& name, const std::string& unit, const disk::h5::Slab& slab,
                               const std::vector<RecordRow>& rows, int begin, int width) {
  const auto from = static_cast<std::size_t>(begin);
  const auto wide = static_cast<std::size_t>(width);
  auto bytes = [&rows, from, wide](std::size_t first, std::size_t count) {
    std::vector<std::byte> buffer(count * wide * sizeof(double));
    std::byte* out = buffer.data();
    for (std::size_t k = first; k < first + count; ++k, out += wide * sizeof(double)) {
      std::memcpy(out, rows[k].record.data() + from, wide * sizeof(double));
    }
    return buffer;
  };
  return {"/particles/" + name,
          unit,
          disk::h5::Handle(H5Tcopy(disk::h5::type_of<double>()), H5Tclose, "copy a type"),
          wide,
          slab,
          bytes};
}

std::vector<disk::h5::Column> plan_columns(const disk::h5::Slab& slab, const std::vector<RecordRow>& rows,
                                           const particles::Layout& layout) {
  std::vector<disk::h5::Column> plan;
  plan.push_back(disk::h5::make_column<std::int64_t>("/particles/id", "", slab, rows,
                                                     [](const RecordRow& row) { return row.id; }));
  plan.push_back(record_column("position", "m", slab, rows, layout.position, layout.dimension));
  plan.push_back(record_column("radius", "m", slab, rows, layout.radius, 1));
  plan.push_back(record_column("velocity", "m/s", slab, rows, layout.velocity, layout.dimension));
  if (layout.rotation) {
    plan.push_back(record_column("surface_speed", "m/s", slab, rows, layout.spin, layout.spin_components()));
  }
  return plan;
}

void write_bytes(hid_t file, const std::string& path, const std::string& text) {
  disk::h5::write_small(file, path, "", std::vector<std::uint8_t>(text.begin(), text.end()));
}

// All of the file but the rows of `plan`.
void write_frame(hid_t file, const std::vector<disk::h5::Column>& plan, const RunState& state, std::uint64_t digest) {
  const std::string text = to_text(state);
  disk::h5::set_fixed_attribute(file, "format", "packmpi-checkpoint");
  disk::h5::set_attribute(file, "format_version", checkpoint_version);
  disk::h5::set_attribute(file, "particle_digest", digest);
  disk::h5::set_attribute(file, "text_digest", fnv_add(fnv_add(fnv_start, text), state.effective_input));
  (void)disk::h5::create_group(file, "/particles");
  write_bytes(file, "/state", text);
  write_bytes(file, "/effective_input", state.effective_input);
  for (const disk::h5::Column& column : plan) disk::h5::create_dataset(file, column);
}

}  // namespace

void write_checkpoint(const comm::Comm& comm, const std::string& path, std::span<const particles::Store* const> stores,
                      const RunState& state) {
  const Occupation now("the checkpoint on its way to the file");
  const disk::h5::Quiet quiet;
  const std::uint64_t digest = digest_of(comm, stores);
  const disk::IdBlocks blocks{state.progress.count, comm.size()};
  std::vector<RecordRow> rows = scatter(comm, blocks, rows_here(stores), &RecordRow::id);
  const GlobalId begin = blocks.begin(comm.rank());
  const disk::h5::Slab slab{static_cast<hsize_t>(state.progress.count), static_cast<hsize_t>(begin), rows.size()};
  comm::agree_on(comm, [&] {
    const bool all = static_cast<GlobalId>(rows.size()) == blocks.begin(comm.rank() + 1) - begin;
    const auto out_of_order = [](const RecordRow& a, const RecordRow& b) { return a.id >= b.id; };
    if (!all || std::ranges::adjacent_find(rows, out_of_order) != rows.end()) {
      throw Error(ExitCode::numerical_failure, "particles were lost; no checkpoint is written");
    }
  });
  const std::vector<disk::h5::Column> plan = plan_columns(slab, rows, stores.front()->layout());
  disk::write_whole_file(comm, path, plan, [&](hid_t file) { write_frame(file, plan, state, digest); });
}

std::int64_t checkpoint_bytes(const particles::Layout& layout, const RunState& state) {
  const disk::h5::Slab slab{static_cast<hsize_t>(state.progress.count), 0, 0};
  const std::vector<RecordRow> none;
  const std::vector<disk::h5::Column> plan = plan_columns(slab, none, layout);
  return disk::whole_file_bytes(plan, [&](hid_t file) { write_frame(file, plan, state, 0); });
}

}  // namespace packmpi::pack
