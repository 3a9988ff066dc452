/// A specimen that is taken out of a pack: `convert --cut`..
#pragma once
#include <memory>
#include <string>

#include "mesh/surface.hpp"
#include "pack/pack_plan.hpp"
#include "scene/scene.hpp"

namespace packmpi::handover {

/// A box, a cylinder, a sphere or a closed surface of a file inside a pack's container. Particles that are wholly
/// inside it are kept, and move with its lower corner to the origin. Local.
class Cut {
 public:
  /// Nothing is cut: all is kept, where it is.
  Cut() = default;
  /// From "cylinder:diameter=15cm,height=0.3,x=0.5". Throws Error(bad_input) that begins with "--cut" on words that
  /// are none, and on a specimen that does not lie inside the container of `scene`.
  /// `surface`: the bytes of the file that file_of() names.
  Cut(const std::string& words, const scene::Scene& scene, const std::string& surface = "");

  /// The file of "specimen.stl:unit=mm,x=0.5"; "": it is none of those.
  [[nodiscard]] static std::string file_of(const std::string& words);

  [[nodiscard]] bool on() const { return shape_ != Shape::none; }
  [[nodiscard]] bool keeps(const Vec3& x, double r) const;
  /// Seen from the specimen's lower corner [m].
  [[nodiscard]] Vec3 place(const Vec3& x) const { return {x[0] - low_[0], x[1] - low_[1], x[2] - low_[2]}; }
  /// Of a sphere of the pack, and its images, the part in the specimen [m3]; 2D: of a disc [m2]. To 1e-9 of its radius
  /// cubed.
  [[nodiscard]] double solid(const Vec3& x, double r) const;
  [[nodiscard]] double volume() const;  ///< [m3] of the specimen; 2D: [m2]
  /// What stands around it: walls and no periods; around a sphere the cube.
  [[nodiscard]] geometry::Container container() const;
  /// "a cylinder of diameter 0.15 m and height 0.3 m"
  [[nodiscard]] std::string words() const;

 private:
  enum class Shape { none, box, cylinder, sphere, surface };
  void read(const std::string& words);
  void check_round(const std::string& words, double slack) const;
  void check_rectangle(const std::string& words, double slack) const;
  [[nodiscard]] double inside(const Vec3& from_centre, double r) const;
  void read_surface(const std::string& words, const std::string& bytes);
  void check_corners(const std::string& words) const;
  void check_in_mesh(const std::string& words, double slack) const;

  Shape shape_ = Shape::none;
  geometry::Container source_;  // that of the pack
  Vec3 size_{};                 // of the box around it
  Vec3 middle_{}, low_{};
  std::shared_ptr<const mesh::Surface> surface_;  // whose box has its middle at middle_
  Vec3 origin_{};                                 // of the file [m]
  std::string file_;                              // its name, without folder
};

}  // namespace packmpi::handover
