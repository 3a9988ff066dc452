/// The spheres of a layer that are placed.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "rsa/cells.hpp"
#include "rsa/excluded.hpp"

namespace packmpi::rsa {

/// In this rank's columns and near them. Only grows.
class Placed {
 public:
  Placed(Bins bins, Excluded excluded) : bins_(std::move(bins)), excluded_(std::move(excluded)) {}

  void add(const Sphere& sphere) {
    bins_.add(sphere, 0);
    excluded_.add(sphere);
  }
  /// Does a trial of this rank's columns overlap one of them?
  [[nodiscard]] bool overlaps(const Sphere& trial) const {
    return excluded_.holds(trial.centre) || bins_.overlaps(trial);
  }
  /// Of each of these trials of this rank's columns, in their order, whether overlaps() is false. Much faster than one
  /// by one: they come in no order of place, so that what they ask for is fetched ahead. A centre may be NaN, which is
  /// nowhere.
  void find_free(std::span<const Trial> trials, std::vector<char>& free);

  /// Fetches what overlaps() will ask for: first the cells, and once they are there the spheres.
  void fetch_cells(const Sphere& trial) const noexcept { bins_.fetch_cells(trial); }
  void fetch_spheres(const Sphere& trial) const noexcept { bins_.fetch_spheres(trial); }

 private:
  void find_free_of(std::span<const Trial> trials, std::span<const std::uint32_t> which, std::vector<char>& free) const;

  Bins bins_;
  Excluded excluded_;
  std::vector<std::uint32_t> left_;  // of find_free(): trials that are not excluded
};

}  // namespace packmpi::rsa
