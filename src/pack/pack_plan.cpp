#include "pack/pack_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>

#include "disk/whole_file.hpp"
#include "report/fields.hpp"
#include "scene/mixture.hpp"

namespace packmpi::pack {
namespace {

std::int32_t component_in(const particles::Store& store, LocalIndex i) {
  return store.layout().component < 0 ? 0 : scene::component_of(store.substance(i).code);
}

std::vector<ParticleRow> rows_here(const PackParts& parts, const disk::IdPiece& piece) {
  const particles::Store& store = *parts.store;
  std::vector<ParticleRow> rows;
  rows.reserve(static_cast<std::size_t>(std::min<std::int64_t>(store.owned(), piece.length)));
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!piece.has(store.ids()[k])) continue;
    rows.push_back({store.ids()[k], store.position(i), store.velocity(i), store.spin(i), store.radius(i),
                    parts.layer[k], parts.contacts[k], component_in(store, i)});
  }
  return rows;
}

[[noreturn]] void fail_ids(std::int64_t total, std::string_view what, GlobalId id) {
  throw Error(ExitCode::numerical_failure,
              fmt::format("the ids of the {} particles are not 0 .. {}: {} {}", total, total - 1, id, what));
}

void check_range(const particles::Store& store, std::int64_t total) {
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const GlobalId id = store.ids()[static_cast<std::size_t>(i)];
    if (id < 0 || id >= total) fail_ids(total, "is out of range", id);
  }
}

void check_complete(const std::vector<ParticleRow>& rows, GlobalId begin, GlobalId end, std::int64_t total) {
  GlobalId expected = begin;
  for (const ParticleRow& row : rows) {
    if (row.id < expected) fail_ids(total, "is there twice", row.id);
    if (row.id > expected) fail_ids(total, "is missing", expected);
    ++expected;
  }
  if (expected < end) fail_ids(total, "is missing", expected);
}

/// Collective. Of contacts (null: none), which the writers of their first particles write.
disk::h5::Slab slab_of_contacts(const comm::Comm& comm, const disk::IdBlocks& blocks,
                                const std::vector<ContactRow>* rows) {
  std::map<Rank, std::int64_t> counts;
  if (rows != nullptr) {
    for (const ContactRow& row : *rows) ++counts[blocks.owner(row.first)];
  }
  return disk::slab_of(comm, disk::count_incoming(comm, counts));
}

/// Collective. Those of a piece to the ranks that write them, in the order of the file; null: none.
std::vector<ContactRow> bring_contacts(const comm::Comm& comm, const disk::IdPiece& piece,
                                       const std::vector<ContactRow>* rows) {
  std::vector<ContactRow> mine;
  if (rows != nullptr) {
    std::ranges::copy_if(*rows, std::back_inserter(mine), [&](const ContactRow& row) { return piece.has(row.first); });
  }
  mine = scatter(comm, piece, std::move(mine), &ContactRow::first);
  std::ranges::sort(mine, [](const ContactRow& a, const ContactRow& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  return mine;
}

void add_particles(const PackBlock& block, std::vector<disk::h5::Column>& plan) {
  const auto& rows = block.rows;
  const disk::h5::Slab& slab = block.particles;
  using Row = ParticleRow;
  plan.push_back(
      disk::h5::make_column<std::int64_t>("/particles/id", "", slab, rows, [](const Row& r) { return r.id; }));
  plan.push_back(
      disk::h5::make_column<double>("/particles/position", "m", slab, rows, [](const Row& r) { return r.position; }));
  plan.push_back(
      disk::h5::make_column<double>("/particles/radius", "m", slab, rows, [](const Row& r) { return r.radius; }));
  plan.push_back(
      disk::h5::make_column<double>("/particles/velocity", "m/s", slab, rows, [](const Row& r) { return r.velocity; }));
  if (block.rotation) {
    plan.push_back(
        disk::h5::make_column<double>("/particles/spin", "rad/s", slab, rows, [](const Row& r) { return r.spin; }));
  }
  plan.push_back(
      disk::h5::make_column<std::int32_t>("/particles/layer", "", slab, rows, [](const Row& r) { return r.layer; }));
  plan.push_back(disk::h5::make_column<std::int32_t>("/particles/contacts", "", slab, rows,
                                                     [](const Row& r) { return r.contacts; }));
  if (!block.mixture) return;
  plan.push_back(disk::h5::make_column<std::int32_t>("/particles/component", "", slab, rows,
                                                     [](const Row& r) { return r.component; }));
}

/// What pairs and walls have alike, into `group`. The names are those of scene::storings.
void add_forces(const std::string& group, const disk::h5::Slab& slab, const std::vector<ContactRow>& rows,
                const scene::Features& features, std::vector<disk::h5::Column>& plan) {
  using Row = ContactRow;
  const auto add = [&](const char* name, const char* unit, auto value) {
    plan.push_back(disk::h5::make_column<double>(group + name, unit, slab, rows, value));
  };
  add("overlap", "m", [](const Row& r) { return r.overlap; });
  add("normal", "-", [](const Row& r) { return r.normal; });
  add("force", "N", [](const Row& r) { return r.force; });
  if (features.memory) add("tangential_displacement", "m", [](const Row& r) { return r.springs.tangential; });
  if (!features.rolling) return;
  add("rolling_displacement", "m", [](const Row& r) { return r.springs.rolling; });
  add("twisting_displacement", "m", [](const Row& r) { return r.springs.twisting; });
}

void add_contacts(const PackBlock& block, std::vector<disk::h5::Column>& plan) {
  using Row = ContactRow;
  plan.push_back(
      disk::h5::make_column<std::int64_t>("/contacts/pair", "", block.contacts, block.contact_rows, [](const Row& r) {
        return std::array<std::int64_t, 2>{r.first, r.second};
      }));
  add_forces("/contacts/", block.contacts, block.contact_rows, block.features, plan);
  plan.push_back(disk::h5::make_column<std::int64_t>("/wall_contacts/particle", "", block.walls, block.wall_rows,
                                                     [](const Row& r) { return r.first; }));
  plan.push_back(disk::h5::make_column<std::int32_t>(
      "/wall_contacts/wall", "", block.walls, block.wall_rows,
      [](const Row& r) { return static_cast<std::int32_t>(neighbor::wall_partner(neighbor::Wall{}) - r.second); }));
  add_forces("/wall_contacts/", block.walls, block.wall_rows, block.features, plan);
}

void add_maps(const PackBlock& block, std::vector<disk::h5::Column>& plan) {
  const auto same = [](double value) { return value; };
  const auto add = [&](const char* path, const char* unit, const std::vector<double>& values) {
    plan.push_back(disk::h5::make_column<double>(path, unit, block.columns, values, same));
  };
  add("/columns/top", "m", block.maps->top);
  add("/columns/solid_fraction", "-", block.maps->solid_fraction);
  add("/columns/vertical_stress", "Pa", block.maps->vertical_stress);
}

/// VTKHDF 1.0, UnstructuredGrid: one cell, a poly-vertex of all particles, from the datasets that are there.
void write_view(hid_t file, const PackBlock& block) {
  constexpr std::uint8_t poly_vertex = 2;
  using Numbers = std::vector<std::int64_t>;
  const auto total = static_cast<std::int64_t>(block.particles.total);
  const disk::h5::Handle view = disk::h5::create_group(file, "/VTKHDF");
  disk::h5::set_attribute(view.get(), "Version", Numbers{1, 0});
  disk::h5::set_fixed_attribute(view.get(), "Type", "UnstructuredGrid");
  disk::h5::write_small(file, "/VTKHDF/NumberOfPoints", "", Numbers{total});
  disk::h5::write_small(file, "/VTKHDF/NumberOfCells", "", Numbers{1});
  disk::h5::write_small(file, "/VTKHDF/NumberOfConnectivityIds", "", Numbers{total});
  disk::h5::write_small(file, "/VTKHDF/Offsets", "", Numbers{0, total});
  disk::h5::write_small(file, "/VTKHDF/Types", "", std::vector<std::uint8_t>{poly_vertex});
  disk::h5::hard_link(file, "/particles/position", "/VTKHDF/Points");
  disk::h5::hard_link(file, "/particles/id", "/VTKHDF/Connectivity");  // row k is particle k, so the ids are 0 .. N-1
  (void)disk::h5::create_group(file, "/VTKHDF/PointData");
  std::vector<std::string> names{"id", "radius", "velocity", "layer", "contacts"};
  if (block.rotation) names.emplace_back("spin");
  if (block.mixture) names.emplace_back("component");
  for (const std::string& name : names) disk::h5::hard_link(file, "/particles/" + name, "/VTKHDF/PointData/" + name);
}

/// "name: unit; ..." for attributes, which cannot have attributes of their own.
std::string list_units(const std::vector<disk::Field>& fields) {
  std::string text;
  for (const disk::Field& field : fields) {
    if (field.unit[0] != '\0') text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", field.name, field.unit);
  }
  return text;
}

/// The measures of rest, each with its limit (see Criterion::asked).
void write_rest(hid_t file, const report::RunRecord& record) {
  const disk::h5::Handle group = disk::h5::create_group(file, "/summary/rest");
  for (const report::Criterion& c : record.criteria) {
    disk::h5::set_attribute(group.get(), c.name, c.value);
    disk::h5::set_attribute(group.get(), fmt::format("{}_limit", c.name).c_str(), c.limit);
  }
  disk::h5::set_attribute(group.get(), "missed", report::missed_words(record, "\n"));
}

void write_summary(hid_t file, const report::RunRecord& record) {
  const disk::h5::Handle group = disk::h5::create_group(file, "/summary");
  std::vector<disk::Field> fields = report::target_fields(record);
  for (disk::Field& field : report::achieved_fields(record)) fields.push_back(std::move(field));
  disk::h5::set_attributes(group.get(), fields);
  disk::h5::set_attribute(group.get(), "units", list_units(fields));
  disk::h5::set_attributes(disk::h5::create_group(file, "/summary/audit").get(), report::audit_fields(record.audit));
  write_rest(file, record);
  (void)disk::h5::create_group(file, "/summary/layers");
  for (const report::LayerColumn& column : report::layer_columns(record)) {
    std::visit(
        [&](const auto& values) {
          disk::h5::write_small(file, std::string("/summary/layers/") + column.name, column.unit, values);
        },
        column.values);
  }
}

}  // namespace

PackBlock make_block(const comm::Comm& comm, const PackParts& parts) {
  PackBlock block;
  block.rotation = parts.store->layout().rotation;
  block.mixture = parts.store->layout().component >= 0;
  const std::int64_t total = comm.sum(std::int64_t{parts.store->owned()});
  comm::agree_on(comm, [&] { check_range(*parts.store, total); });

  const disk::IdBlocks blocks{total, comm.size()};
  block.particles = disk::slab_of(comm, blocks.begin(comm.rank() + 1) - blocks.begin(comm.rank()));
  block.has_contacts = parts.contact_rows != nullptr;
  if (block.has_contacts) {
    block.features = parts.features;
    block.contacts = slab_of_contacts(comm, blocks, parts.contact_rows);
    block.walls = slab_of_contacts(comm, blocks, parts.wall_rows);
  }
  block.maps = parts.maps;
  if (block.maps != nullptr) block.columns = disk::slab_of(comm, std::ssize(block.maps->top));
  return block;
}

void bring_rows(const comm::Comm& comm, const PackParts& parts, const disk::IdPiece& piece, PackBlock& block) {
  block.rows = scatter(comm, piece, rows_here(parts, piece), &ParticleRow::id);
  comm::agree_on(
      comm, [&] { check_complete(block.rows, piece.begin(comm.rank()), piece.end(comm.rank()), piece.blocks.total); });
  if (!block.has_contacts) return;
  block.contact_rows = bring_contacts(comm, piece, parts.contact_rows);
  block.wall_rows = bring_contacts(comm, piece, parts.wall_rows);
}

std::vector<disk::h5::Column> plan_columns(const PackBlock& block) {
  std::vector<disk::h5::Column> plan;
  add_particles(block, plan);
  if (block.has_contacts) add_contacts(block, plan);
  if (block.maps != nullptr) add_maps(block, plan);
  return plan;
}

void write_frame(hid_t file, const PackBlock& block, const std::vector<disk::h5::Column>& plan,
                 const report::RunRecord& record) {
  disk::h5::set_attribute(file, "format", std::string("packmpi-pack"));
  disk::h5::set_attribute(file, "format_version", pack_version);
  (void)disk::h5::create_group(file, "/particles");
  if (block.has_contacts) {
    (void)disk::h5::create_group(file, "/contacts");
    (void)disk::h5::create_group(file, "/wall_contacts");
  }
  if (block.maps != nullptr) {
    const disk::h5::Handle columns = disk::h5::create_group(file, "/columns");
    disk::h5::set_attribute(columns.get(), "counts",
                            std::vector<std::int64_t>(block.maps->counts.begin(), block.maps->counts.end()));
    disk::h5::set_attribute(columns.get(), "widths",
                            std::vector<double>(block.maps->widths.begin(), block.maps->widths.end()));
    disk::h5::set_attribute(columns.get(), "units", std::string("widths: m"));
  }
  for (const disk::h5::Column& column : plan) disk::h5::create_dataset(file, column);
  write_summary(file, record);
  disk::h5::set_attributes(disk::h5::create_group(file, "/provenance").get(), report::provenance_fields(record));
  write_view(file, block);
}

}  // namespace packmpi::pack
