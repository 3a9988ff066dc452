/// A made-up run and its folder, for the tests of this module.
#pragma once
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "pack/pack.hpp"
#include "report/record.hpp"
#include "support/scattered.hpp"

namespace packmpi::testing {

/// A new folder on rank 0, removed with all that is in it at the end. Collective.
class Folder {
 public:
  explicit Folder(const comm::Comm& comm, const std::filesystem::path& parent = std::filesystem::temp_directory_path())
      : comm_(&comm) {
    std::string pattern = (parent / "packmpi-test-XXXXXX").string();
    if (comm.rank() == 0 && mkdtemp(pattern.data()) == nullptr) std::abort();
    path_ = comm.broadcast(0, pattern);
  }
  ~Folder() {
    comm_->barrier();
    std::error_code ignored;
    if (comm_->rank() == 0) std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  const comm::Comm* comm_;
  std::string path_;
};

inline std::vector<Grain> some_grains(std::size_t count, int dimension) {
  Scatter u;
  std::vector<Grain> grains(count);
  for (Grain& g : grains) {
    g.r = 0.01 + u();
    for (std::size_t c = 0; c < static_cast<std::size_t>(dimension); ++c) g.x[c] = u(), g.v[c] = u() - 0.5;
    g.w = dimension == 3 ? Vec3{u(), u(), u()} : Vec3{0.0, 0.0, u()};
  }
  return grains;
}

/// What write_pack() takes, on this rank.
struct Parts {
  particles::Store store;
  std::vector<std::int32_t> layer, contacts;
  std::vector<pack::ContactRow> rows, wall_rows;

  [[nodiscard]] pack::PackParts view(bool with_contacts) const {
    return {.store = &store,
            .layer = layer,
            .contacts = contacts,
            .contact_rows = with_contacts ? &rows : nullptr,
            .wall_rows = &wall_rows,
            .features = {.memory = true, .rolling = true}};
  }
};

inline std::int32_t layer_of(GlobalId id) { return static_cast<std::int32_t>(id / 10); }
inline std::int32_t contacts_of(GlobalId id) { return static_cast<std::int32_t>(id % 13); }

/// Contacts between each particle and some later ones.
inline std::vector<pack::ContactRow> contact_rows(GlobalId id, std::size_t count) {
  std::vector<pack::ContactRow> rows;
  for (const GlobalId step : {17, 3, 1}) {
    if (id % 4 == 0 || id + step >= static_cast<GlobalId>(count)) continue;
    const auto x = static_cast<double>(100 * id + step);
    rows.push_back({.first = id,
                    .second = id + step,
                    .overlap = 1.0 / x,
                    .force = {x, -x, 0.5 * x},
                    .normal = {0.0, 0.6, x > 0.0 ? 0.8 : -0.8},
                    .springs = {{2.0 * x, x, -x}, {x, 3.0 * x, x}, -x}});
  }
  return rows;
}

/// Every third particle is in a corner.
inline std::vector<pack::ContactRow> wall_rows(GlobalId id) {
  if (id % 3 != 0) return {};
  const auto x = static_cast<double>(id);
  return {{.first = id, .second = -1, .overlap = 0.5 * x, .force = {0.0, 0.0, x}},
          {.first = id, .second = -4, .overlap = x, .force = {1.0, x, 0.0}}};
}

inline Parts make_parts(const comm::Comm& comm, const particles::Layout& layout, const std::vector<Grain>& grains,
                        Spread spread) {
  Parts parts{scattered(comm, layout, grains, spread), {}, {}, {}, {}};
  for (LocalIndex i = 0; i < parts.store.owned(); ++i) {
    const GlobalId id = parts.store.ids()[static_cast<std::size_t>(i)];
    parts.layer.push_back(layer_of(id));
    parts.contacts.push_back(contacts_of(id));
    for (const auto& row : contact_rows(id, grains.size())) parts.rows.push_back(row);
    for (const auto& row : wall_rows(id)) parts.wall_rows.push_back(row);
  }
  return parts;
}

inline report::RunRecord some_record(int dimension, std::size_t layers) {
  report::RunRecord r;
  r.name = "sample";
  r.scene_file = "input/sample.toml";
  r.effective_input =
      "schema_version = 1\nseed = 7  # \xC2\xB5m\n" + std::string(70000, '#') + "\n";  // more than 64 kB
  r.seed = 18446744073709551615u;
  r.dimension = dimension;
  r.size = {1.0, 2.0, dimension == 3 ? 0.5 : 0.0};
  r.target_height = 0.5;
  r.target_fraction = 0.25;
  r.particles = 1234567890123;
  r.height = 0.512345678901234;
  r.phi = 0.1 + 0.2;
  r.floor_force = 1.0e-3;
  r.weight = 1.0e-3;
  r.stop_reason = "height reached";
  r.reached = true;
  for (std::size_t k = 0; k < layers; ++k) {
    report::LayerRow row;
    row.inserted = 1000000000 + static_cast<std::int64_t>(k);
    row.total = row.inserted * static_cast<std::int64_t>(k + 1);
    row.steps = 10000;
    row.achieved_fraction = 0.2501234;
    row.height = 0.1 * static_cast<double>(k + 1);
    row.kinetic_per_mgd = 1.2345e-12;
    row.max_overlap = 1.0e-3;
    row.stop_reason = k % 2 == 0 ? "duration" : "settled";
    r.layers.push_back(row);
  }
  r.criteria = {{.name = "unbalanced_force", .words = "unbalanced force ratio", .value = 0.25, .limit = 0.05},
                {.name = "support",
                 .words = "force of floor and walls over weight",
                 .value = 0.99,
                 .limit = 0.02,
                 .target = 1.0}};
  r.missed = {"rest.unbalanced_force: it is 0.25", "another target"};
  r.audit.expected = r.audit.found = 1234567890123;
  r.ranks = 3;
  r.version = "0.1.0";
  r.wall_seconds = 12.5;
  return r;
}

}  // namespace packmpi::testing
