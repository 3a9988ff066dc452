/// A pack file, open for reading in slices. Private to this module.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "confine/state.hpp"
#include "disk/sealed_file.hpp"
#include "pack/checkpoint.hpp"
#include "pack/pack.hpp"

namespace packmpi::pack {

/// A contact that a pack tells of.
struct TouchingRow {
  GlobalId first = 0, second = 0;  ///< first < second; at a wall: the particle, and -1
  std::int32_t wall = -1;          ///< its number (doc/file_format.md); -1: there are two particles
  double overlap = 0.0;            ///< [m]
  Vec3 normal{};                   ///< from the first to the second or into the wall
  Vec3 force{};                    ///< [N] on the first
  Vec3 tangential{};               ///< [m] of the spring of friction, of the second or the wall past the first
};

/// Rank-local; several ranks may each have the same file open. Errors: Error(io_failure), words without the path.
class PackFile {
 public:
  /// Opens it, once all but its rows is known to be what was written; checks the format version, the dimension and the
  /// shape of /particles/id. Whoever reads rows calls check_rows() with seal() before.
  explicit PackFile(const std::string& path);

  [[nodiscard]] const disk::Seal& seal() const noexcept { return file_.seal(); }
  [[nodiscard]] int dimension() const noexcept { return dimension_; }
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }  ///< particles
  [[nodiscard]] bool rotation() const noexcept { return rotation_; }    ///< spins are there
  /// Rows [begin, begin + count) of all particle datasets. Their shapes are checked, and that they can be particles:
  /// ids in order, numbers finite, radii above 0. Cost: O(count).
  [[nodiscard]] PackRows rows(std::int64_t begin, std::int64_t count) const;
  /// What the contacts remember, of this rank's share of their rows, wherever their particles are; no memory in
  /// `features` if the pack has none of it. It is checked that ends can be those of two of the particles or of one and
  /// a wall, and that numbers are finite. Cost: O(share).
  [[nodiscard]] Histories histories(Rank rank, int ranks) const;
  [[nodiscard]] bool has_springs() const { return file_.has("/contacts/tangential_displacement"); }
  /// All contacts with their springs of friction, those at walls last; none if the pack does not have them. Ends and
  /// numbers are checked. Cost: O(contacts), 120 bytes each.
  [[nodiscard]] std::vector<TouchingRow> touching() const;
  [[nodiscard]] confine::State confined() const;  ///< lid and sides; off if there are none
  [[nodiscard]] std::string scene() const;        ///< the effective input, in the keys of today
  [[nodiscard]] std::string text(const char* object, const char* attribute) const;
  [[nodiscard]] double number(const char* object, const char* attribute) const;

 private:
  disk::SealedFile file_;
  std::int64_t version_ = 0;
  int dimension_ = 3;
  std::int64_t count_ = 0;
  bool rotation_ = false;
};

}  // namespace packmpi::pack
