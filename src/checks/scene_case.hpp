/// A scene under check. Private to this module.
#pragma once
#include <fmt/format.h>

#include <numbers>
#include <string>
#include <string_view>

#include "config/input.hpp"
#include "config/radius_range.hpp"
#include "config/vessel.hpp"
#include "document/document.hpp"

namespace packmpi::input {

using document::Document;

/// The scene under check, and a few lengths every check asks for.
struct Case {
  const Input& in;
  const Document& document;

  [[noreturn]] void refuse(std::string_view path, const std::string& words) const {
    document::fail(document.place(path), path, words);
  }
  [[nodiscard]] const Radius& radius() const { return in.particles.radius; }
  [[nodiscard]] bool equal() const { return radius().distribution == SizeDistribution::equal; }
  [[nodiscard]] bool plane() const { return in.container.dimension == 2; }
  [[nodiscard]] double smallest() const { return radius_range(radius()).smallest; }
  [[nodiscard]] double largest() const { return radius_range(radius()).largest; }
  [[nodiscard]] const char* largest_key() const {
    switch (radius().distribution) {
      case SizeDistribution::equal:
        return "particles.radius.value";
      case SizeDistribution::bidisperse:
        return "particles.radius.large";
      case SizeDistribution::discrete:
      case SizeDistribution::list:
        return "particles.radius.radii";
      case SizeDistribution::grading:
        return "particles.radius.diameter_curve";
      default:
        return "particles.radius.max";
    }
  }
  [[nodiscard]] double height() const { return in.container.size.back(); }
  /// How many particles of radius r fill the solid fraction `fraction` of a box `high` [m] on the container's floor.
  /// A product of ratios, so that no power of a length under- or overflows on its own.
  [[nodiscard]] double particles_in(double high, double fraction, double r) const {
    double count = fraction * (high / r) / (plane() ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi);
    for (int axis = 0; axis + 1 < in.container.dimension; ++axis) {
      count *= in.container.size[static_cast<std::size_t>(axis)] / r;
    }
    if (boxed()) return count;
    const auto& size = in.container.size;
    return count * (container_of(in.container).mean_area() / (plane() ? size[0] : size[0] * size[1]));
  }
  [[nodiscard]] bool is(VesselShape shape) const { return in.container.shape == shape; }
  [[nodiscard]] bool boxed() const { return in.container.shape == VesselShape::box; }
  /// The key of an extent of the container.
  [[nodiscard]] std::string extent_key(std::size_t axis) const {
    if (boxed()) return fmt::format("container.size[{}]", axis);
    return axis + 1 == in.container.size.size() ? "container.height" : extent_key();
  }
  [[nodiscard]] const char* extent_key() const {
    if (is(VesselShape::polygon)) return "container.polygon";
    if (is(VesselShape::trapezium))
      return in.container.bottom_width < in.container.top_width ? "container.top_width" : "container.bottom_width";
    if (is(VesselShape::mesh))
      return document.find("container.polygon") != nullptr ? "container.polygon" : "container.file";
    if (!is(VesselShape::frustum)) return boxed() ? "container.size" : "container.diameter";
    return in.container.bottom_diameter < in.container.top_diameter ? "container.top_diameter"
                                                                    : "container.bottom_diameter";
  }
};

/// The largest particle fits into the vessel and the layers, and what only some vessels have.
void check_vessel(const Case& scene);

}  // namespace packmpi::input
