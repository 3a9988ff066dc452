/// Faces, edges and corners of a surface, as contacts see them: what of it can be the nearest to a point of the
/// interior, locally.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/contact.hpp"
#include "mesh/shell.hpp"

namespace packmpi::mesh {

/// Triangles of one plane that hang together are one face: seams inside it are nothing. Edges are those that stick out
/// into the interior between two faces; in inner corners two faces are touched. Corners are the ends of such edges.
/// Local.
class Features {
 public:
  Features() = default;
  explicit Features(const Shell& shell);

  [[nodiscard]] std::int32_t count() const { return corner_begin_ + static_cast<std::int32_t>(corners_.size() / 3); }
  [[nodiscard]] std::int32_t edge_begin() const { return edge_begin_; }
  [[nodiscard]] std::int32_t corner_begin() const { return corner_begin_; }
  /// For a step; lives as long as this. `deepest`: see Table.
  [[nodiscard]] Table table(double deepest) const {
    return {faces_.data(),     triangles_.data(), edges_.data(), corners_.data(), spokes_.data(),
            spokes_of_.data(), patch_.data(),     edge_begin_,   corner_begin_,   deepest};
  }
  [[nodiscard]] std::int32_t face_of(std::size_t triangle) const { return face_of_[triangle]; }
  /// Numbers of the edge across each side of a triangle and of the corner at each of its points; -1: there is none.
  [[nodiscard]] const std::array<std::int32_t, 3>& edges_of(std::size_t triangle) const { return edges_of_[triangle]; }
  [[nodiscard]] const std::array<std::int32_t, 3>& corners_of(std::size_t triangle) const {
    return corners_of_[triangle];
  }
  /// Faces that meet at less than smooth_angle are one patch, as those of a round wall are, with the edges between them
  /// and the corners that have no other face and no sharper edge. What stands alone has a number of its own.
  [[nodiscard]] std::int32_t patch_of(std::int32_t feature) const { return patch_[static_cast<std::size_t>(feature)]; }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  void find_faces(const Shell& shell);
  void find_sides(const Shell& shell);
  void find_edges(const Shell& shell);
  void find_corners(const Shell& shell);
  void find_patches(const Shell& shell);
  [[nodiscard]] const double* side(std::size_t triangle, std::size_t k) const {
    return triangles_.data() + 12 * triangle + 4 * k;
  }

  std::int32_t edge_begin_ = 0, corner_begin_ = 0;
  std::vector<double> faces_, triangles_, edges_, corners_, spokes_;
  std::vector<std::int32_t> spokes_of_{0}, face_of_, patch_;
  std::vector<std::array<std::int32_t, 3>> edges_of_, corners_of_;
};

}  // namespace packmpi::mesh
