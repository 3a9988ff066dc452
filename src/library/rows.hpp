/// The rows of a pack in memory. Private to this module.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "observe/column_maps.hpp"
#include "observe/measure.hpp"
#include "packmpi/packing.hpp"
#include "particles/store.hpp"
#include "report/record.hpp"
#include "run/bed.hpp"

namespace packmpi {

/// Contacts as the arrays that ContactSpans shows.
struct ContactArrays {
  std::vector<std::int64_t> pair;
  std::vector<std::int32_t> wall;
  std::vector<double> overlap, normal, force, displacement;
};

/// What a Packing holds. Particles are in `store`, too, to the bit as they were integrated: spins are kept there as
/// surface speeds, and a pack file is written from it.
struct Packing::Rows {
  explicit Rows(const particles::Layout& layout) : store(layout) {}

  particles::Store store;
  std::vector<std::int64_t> id;
  std::vector<double> position, radius, velocity, spin;
  std::vector<std::int32_t> layer, contacts, component;
  std::vector<observe::ContactForce> pair_rows, wall_rows;
  ContactArrays pair_arrays, wall_arrays;
  ContactSpans pairs, walls;
  observe::ColumnMaps maps;
  scene::Features features{};
  bool writes_contacts = false;  ///< output.contacts
  report::RunRecord record;
  std::string summary;
};

namespace library {

/// Collective. This rank's share of a bed that is measured.
[[nodiscard]] std::shared_ptr<const Packing::Rows> rows_of(const run::Bed& bed, const report::RunRecord& record);

}  // namespace library
}  // namespace packmpi
