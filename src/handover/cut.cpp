#include "handover/cut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "geometry/cut_volume.hpp"
#include "geometry/round_volume.hpp"
#include "geometry/volume.hpp"
#include "mesh/file.hpp"
#include "tables/units.hpp"

namespace packmpi::handover {
namespace {

[[noreturn]] void refuse_cut(const std::string& words, const std::string& reason) {
  throw Error(ExitCode::bad_input, fmt::format("--cut {}: {}", words, reason));
}

/// The names of a shape's lengths, those that it must have first.
struct LengthNames {
  std::string shape;
  std::vector<std::string> lengths;
};

LengthNames names_of(const std::string& words, const std::string& shape, bool flat) {
  const std::vector<LengthNames> all{
      {"box", {"length", "width", "height"}}, {"cylinder", {"diameter", "height"}}, {"sphere", {"diameter"}}};
  for (const LengthNames& names : all) {
    if (names.shape != shape) continue;
    if (!flat) return names;
    if (shape == "box") return {"box", {"length", "height"}};
    refuse_cut(words, fmt::format("a {} is cut out of packs in 3D; of one in 2D a box is", shape));
  }
  const auto near = text::closest(shape, std::vector<std::string>{"box", "cylinder", "sphere"});
  refuse_cut(words, fmt::format("\"{}\" is no shape; there are box, cylinder, sphere and files that end in .stl or "
                                ".obj{}",
                                shape, near ? fmt::format(" (did you mean {}?)", *near) : ""));
}

double read_metres(const std::string& words, const std::string& name, const std::string& value, bool place) {
  tables::Scalar read = tables::parse_scalar(value, tables::length);
  if (!read.value) {
    char* end = nullptr;
    const double plain = std::strtod(value.c_str(), &end);
    if (!value.empty() && *end == '\0') read.value = plain;
  }
  if (read.value && std::isfinite(*read.value) && (place || *read.value > 0.0)) return *read.value;
  refuse_cut(words,
             fmt::format("{} is \"{}\"; give a length{} such as 0.15 or 15cm", name, value, place ? "" : " above 0"));
}

/// What stands behind the colon, by its names: words.
std::map<std::string, std::string> read_items(const std::string& words, const std::string& list,
                                              const std::string& shape, const std::vector<std::string>& known) {
  std::map<std::string, std::string> found;
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string item = list.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = std::min(item.find('='), item.size());
    const std::string name(text::trimmed(item.substr(0, equals)));
    if (std::ranges::find(known, name) == known.end()) {
      std::string there;
      for (const std::string& one : known) there += (there.empty() ? "" : ", ") + one;
      refuse_cut(words, fmt::format("a {} has no \"{}\"; there are {}", shape, name, there));
    }
    if (!found.emplace(name, text::trimmed(equals < item.size() ? item.substr(equals + 1) : "")).second) {
      refuse_cut(words, fmt::format("{} is there twice", name));
    }
  }
  return found;
}

std::map<std::string, double> read_lengths(const std::string& words, const std::string& list, const LengthNames& names,
                                           bool flat) {
  std::vector<std::string> known = names.lengths;
  for (const char* axis : {"x", "y", "z"}) {
    if (!(flat && *axis == 'z')) known.emplace_back(axis);
  }
  std::map<std::string, double> found;
  for (const auto& [name, value] : read_items(words, list, names.shape, known)) {
    found[name] = read_metres(words, name, value, name.size() == 1);
  }
  return found;
}

/// How long the unit of a file is [m].
double read_unit(const std::string& words, const std::string& unit) {
  const tables::Scalar read = tables::parse_scalar("1 " + unit, tables::length);
  if (read.value) return *read.value;
  refuse_cut(words, fmt::format("unit is \"{}\"; give one of lengths, such as mm", unit));
}

}  // namespace

std::string Cut::file_of(const std::string& words) {
  for (std::size_t end = 4; end <= words.size(); ++end) {
    if ((end == words.size() || words[end] == ':') && mesh::names_mesh(words.substr(0, end)))
      return words.substr(0, end);
  }
  return "";
}

Cut::Cut(const std::string& words, const scene::Scene& scene, const std::string& surface) : source_(scene.container) {
  if (file_of(words).empty()) {
    read(words);
  } else {
    read_surface(words, surface);
  }
  for (std::size_t a = 0; a < 3; ++a) low_[a] = middle_[a] - 0.5 * size_[a];
  if (shape_ == Shape::surface) check_corners(words);
  const double slack = 1e-12 * *std::ranges::max_element(source_.size);
  Vec3 extent = source_.size;
  if (source_.lid) extent[static_cast<std::size_t>(source_.vertical())] = *source_.lid;
  for (std::size_t a = 0; a < static_cast<std::size_t>(source_.dimension); ++a) {
    if (low_[a] >= -slack && low_[a] + size_[a] <= extent[a] + slack) continue;
    refuse_cut(words,
               fmt::format("it reaches from {:g} to {:g} m along {}, and the container from 0 to {:g} m; make it "
                           "smaller or move it",
                           low_[a], low_[a] + size_[a], "xyz"[a], extent[a]));
  }
  if (source_.is_mesh()) {
    check_in_mesh(words, slack);
  } else if (!source_.is_box() && shape_ != Shape::surface) {
    check_round(words, slack);
  }
}

// Sections of vessels are convex upwards but for their middle: if both ends of the specimen lie inside, all of it does.
void Cut::check_round(const std::string& words, double slack) const {
  if (source_.dimension == 2) return check_rectangle(words, slack);
  if (shape_ == Shape::sphere) {
    const double away = source_.from_sides(middle_);
    if (away + slack >= 0.5 * size_[0]) return;
    refuse_cut(words, fmt::format("its middle is {:g} m from the vessel's wall; make it smaller or move it", away));
  }
  const double low = low_[2], high = low_[2] + size_[2];
  const double x = std::abs(middle_[0] - source_.radius()), y = std::abs(middle_[1] - source_.radius());
  const bool box = shape_ == Shape::box;
  const double half = 0.5 * size_[0], across = 0.5 * size_[1];
  const double farthest = box ? std::hypot(x + half, y + across) : std::hypot(x, y) + half;
  const double around = std::min(source_.ring(low, 0.0).outer, source_.ring(high, 0.0).outer);
  if (farthest > around + slack) {
    refuse_cut(words, fmt::format("it reaches {:g} m from the axis of the {}, whose radius is {:g} m{}; make it "
                                  "smaller or move it",
                                  farthest, source_.shape == geometry::Shape::cylinder ? "cylinder" : "vessel", around,
                                  source_.straight() ? "" : " there"));
  }
  const double nearest =
      box ? std::hypot(std::max(0.0, x - half), std::max(0.0, y - across)) : std::max(0.0, std::hypot(x, y) - half);
  if (source_.has(geometry::Surface::inner) && nearest < source_.core - slack) {
    refuse_cut(words, fmt::format("it reaches to {:g} m from the axis of the annulus, whose inner wall has a radius of "
                                  "{:g} m; make it smaller or move it",
                                  nearest, source_.core));
  }
}

// Vessels in 2D are convex: if its corners lie inside, all of it does.
void Cut::check_rectangle(const std::string& words, double slack) const {
  for (const double x : {low_[0], low_[0] + size_[0]}) {
    for (const double y : {low_[1], low_[1] + size_[1]}) {
      if (source_.beyond({x, y, 0.0}) <= slack) continue;
      refuse_cut(words,
                 fmt::format("its corner ({:g}, {:g}) m is outside the vessel; make it smaller or move it", x, y));
    }
  }
}

// The vessel around it is convex: if its corners lie inside, all of it does. Of a box, what is around it will be looked
// at.
void Cut::check_corners(const std::string& words) const {
  const double slack = 1e-12 * *std::ranges::max_element(source_.size);
  if (source_.has(geometry::Surface::inner)) {
    refuse_cut(words, "it may reach around the inner wall of the annulus; cut a box, a cylinder or a sphere");
  }
  for (const Vec3& point : surface_->shell().points) {
    const Vec3 x{point[0] + origin_[0], point[1] + origin_[1], point[2] + origin_[2]};
    if (source_.is_box() || source_.is_mesh() || source_.beyond(x) <= slack) continue;
    refuse_cut(words,
               fmt::format("its corner at ({:g}, {:g}, {:g}) m lies outside the vessel; make it smaller or move it",
                           x[0], x[1], x[2]));
  }
}

// The box around it is inside, not only its corners.
void Cut::check_in_mesh(const std::string& words, double slack) const {
  Vec3 low = low_, high = low_;
  for (std::size_t a = 0; a < 3; ++a) low[a] += slack, high[a] += size_[a] - slack;
  if (!source_.interior->meets_box(low, high) && source_.holds(middle_, 0.0)) return;
  refuse_cut(words, "the box around it does not lie inside the mesh that the pack is in; make it smaller or move it");
}

void Cut::read_surface(const std::string& words, const std::string& bytes) {
  if (source_.dimension == 2) refuse_cut(words, "a surface is cut out of packs in 3D; of one in 2D a box is");
  shape_ = Shape::surface;
  const std::string path = file_of(words);
  file_ = std::filesystem::path(path).filename().string();
  const auto found =
      read_items(words, words.substr(std::min(path.size() + 1, words.size())), "surface", {"unit", "x", "y", "z"});
  const double unit = found.contains("unit") ? read_unit(words, found.at("unit")) : 1.0;
  try {
    surface_ = mesh::make_surface(bytes, path, unit);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("--cut {}", error.what()));
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis(1, "xyz"[a]);
    const double low = surface_->low()[a], high = surface_->high()[a];
    size_[a] = high - low;
    if (found.contains(axis)) {
      origin_[a] = read_metres(words, axis, found.at(axis), true) - 0.5 * (low + high);
    }
    middle_[a] = 0.5 * (low + high) + origin_[a];
  }
}

void Cut::read(const std::string& words) {
  const bool flat = source_.dimension == 2;
  const std::size_t colon = std::min(words.find(':'), words.size());
  const LengthNames names = names_of(words, words.substr(0, colon), flat);
  const auto found = read_lengths(words, colon < words.size() ? words.substr(colon + 1) : "", names, flat);
  const auto length = [&](const std::string& name, double otherwise) {
    const auto at = found.find(name);
    return at == found.end() ? otherwise : at->second;
  };
  const auto up = static_cast<std::size_t>(source_.vertical());
  const double height = source_.lid.value_or(source_.height());
  if (names.shape != "box" && !found.contains("diameter")) refuse_cut(words, "its diameter is missing");
  if (names.shape == "box") {
    shape_ = Shape::box;
    size_ = {length("length", source_.size[0]), length("width", source_.size[1]), 0.0};
    size_[up] = length("height", height);
  } else {
    shape_ = names.shape == "cylinder" ? Shape::cylinder : Shape::sphere;
    size_.fill(length("diameter", 0.0));
    if (shape_ == Shape::cylinder) size_[2] = length("height", height);
  }
  middle_ = {length("x", 0.5 * source_.size[0]), length("y", 0.5 * source_.size[1]), 0.0};
  middle_[up] = length(std::string(1, "xyz"[up]), 0.5 * height);
}

bool Cut::keeps(const Vec3& x, double r) const {
  const Vec3 d{x[0] - middle_[0], x[1] - middle_[1], x[2] - middle_[2]};
  if (shape_ == Shape::none) return true;
  if (shape_ == Shape::surface) {
    return surface_->distance({x[0] - origin_[0], x[1] - origin_[1], x[2] - origin_[2]}, r) >= r;
  }
  if (shape_ == Shape::sphere) return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + r <= 0.5 * size_[0];
  const auto fits = [&](std::size_t a) { return std::abs(d[a]) + r <= 0.5 * size_[a]; };
  if (source_.dimension == 2) return fits(0) && fits(1);
  if (shape_ == Shape::cylinder) return std::sqrt(d[0] * d[0] + d[1] * d[1]) + r <= 0.5 * size_[0] && fits(2);
  return fits(0) && fits(1) && fits(2);
}

double Cut::inside(const Vec3& d, double r) const {
  const Vec3 half{0.5 * size_[0], 0.5 * size_[1], 0.5 * size_[2]};
  if (shape_ == Shape::surface) {
    const auto at = [&](std::size_t a) { return middle_[a] + d[a] - origin_[a]; };
    return surface_->volume_of_sphere({at(0), at(1), at(2)}, r);
  }
  if (shape_ == Shape::sphere) {
    return geometry::volume_in_sphere(r, std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), half[0]);
  }
  if (shape_ == Shape::cylinder) {
    return geometry::volume_in_cylinder(r, std::sqrt(d[0] * d[0] + d[1] * d[1]), half[0], -half[2] - d[2],
                                        half[2] - d[2]);
  }
  const Vec3 low{-half[0] - d[0], -half[1] - d[1], -half[2] - d[2]},
      high{half[0] - d[0], half[1] - d[1], half[2] - d[2]};
  if (source_.dimension == 2) return geometry::area_in_rectangle(r, low, high);
  return geometry::volume_in_box(r, low, high);
}

double Cut::solid(const Vec3& x, double r) const {
  const auto images = [&](std::size_t a) { return a < 2 && source_.periodic[a] ? 1 : 0; };
  double sum = 0.0;
  for (int i = -images(0); i <= images(0); ++i) {
    for (int k = -images(1); k <= images(1); ++k) {
      sum += inside(
          {x[0] + i * source_.size[0] - middle_[0], x[1] + k * source_.size[1] - middle_[1], x[2] - middle_[2]}, r);
    }
  }
  return sum;
}

double Cut::volume() const {
  switch (shape_) {
    case Shape::cylinder:
      return geometry::volume(2, 0.5 * size_[0]) * size_[2];
    case Shape::sphere:
      return geometry::volume(3, 0.5 * size_[0]);
    case Shape::surface:
      return surface_->volume();
    default:
      return source_.dimension == 2 ? size_[0] * size_[1] : size_[0] * size_[1] * size_[2];
  }
}

geometry::Container Cut::container() const {
  geometry::Container box;
  box.dimension = source_.dimension;
  box.size = size_;
  if (shape_ == Shape::cylinder) box.shape = geometry::Shape::cylinder;
  return box;
}

std::string Cut::words() const {
  if (shape_ == Shape::cylinder)
    return fmt::format("a cylinder of diameter {:g} m and height {:g} m", size_[0], size_[2]);
  if (shape_ == Shape::sphere) return fmt::format("a sphere of diameter {:g} m", size_[0]);
  if (shape_ == Shape::surface) {
    return fmt::format("the interior of {:g} m3 inside the {} triangles of {}{}", surface_->volume(),
                       surface_->shell().triangles.size(), text::printable(file_),
                       mesh::mended_words(surface_->shell().mended));
  }
  if (source_.dimension == 2) return fmt::format("a rectangle of {:g} x {:g} m", size_[0], size_[1]);
  return fmt::format("a box of {:g} x {:g} x {:g} m", size_[0], size_[1], size_[2]);
}

}  // namespace packmpi::handover
