#include "forecast/solve.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "control/filling.hpp"
#include "geometry/volume.hpp"
#include "tables/units.hpp"

namespace packmpi::forecast {

scene::BedFraction fraction_of(const scene::Scene& scene, const Question& question) {
  constexpr double border = 0.01;  // what floor and surface may take from a target, which is of the bulk
  if (question.fraction) return {*question.fraction, 0.0};
  if (insertion_alone(scene.in)) return {scene.in.layers.fraction, 0.0};
  if (scene.in.target && !scene.in.target->relative_density) {
    return {control::fraction_wanted(*scene.in.target, {}), border};
  }
  return scene::expected_fraction(scene);
}

bool has_size(const geometry::Container& vessel) {
  return vessel.is_box() || vessel.shape == geometry::Shape::cylinder;
}
bool fits_thickness(const scene::Scene& scene) {
  return scene.in.layers.region == input::RegionRule::open && !scene.container.is_mesh() && !insertion_alone(scene.in);
}

namespace {

constexpr int turns = 3;        // walls and surface make a bed looser: the fraction depends on what is looked for
constexpr double margin = 0.5;  // of a layer, by which the last one rises above a height that is found

[[noreturn]] void refuse(const std::string& words) { throw Error(ExitCode::bad_input, "estimate: " + words); }

double mean_volume(const scene::Scene& scene) {
  return geometry::volume(scene.container.dimension, 1.0) * scene.sizes.curve().moment(scene.container.dimension);
}

// So many layers of `particles` particles on the floor of the scene; the layer's thickness is fitted so that whole ones
// make it.
struct Fitted {
  double thickness, height;
};
Fitted fit_height(const scene::Scene& scene, double particles, double layers, double fraction) {
  const double solid =
      (particles / layers - margin) * mean_volume(scene);  // of a layer: insertion overshoots by half a particle
  return {.thickness = solid / (scene.in.layers.fraction * scene.container.mean_area()),
          .height = (layers - margin) * solid / (fraction * scene.container.mean_area())};
}

// H_d below which so many particles fit, between the shape's own walls. A frustum keeps its diameters; a mesh `grows`
// or not.
double fit_extent(const scene::Scene& scene, bool grows, double particles, double fraction) {
  const geometry::Container& vessel = scene.container;
  const bool clipped = scene.in.layers.region == input::RegionRule::container;
  const double target = vessel.height();
  const double below = clipped ? scene::height_below(scene, target) : target;
  const double left = target - below;
  const bool flat = scene.in.container.shape == input::VesselShape::polygon;
  const bool fixed = (vessel.is_mesh() && !grows) || vessel.shape == geometry::Shape::sphere || flat;
  if (!fixed) return particles * mean_volume(scene) / (vessel.mean_area(0.0, below) * fraction) + left;
  const double top = flat ? vessel.polygon->top() : vessel.is_mesh() ? vessel.interior->high()[2] : vessel.size[0];
  const double height = vessel.level(particles * mean_volume(scene) / fraction) + left;
  if (height <= top) return height;
  refuse(
      fmt::format("{} particles do not fit into this vessel, which takes about {:.0f}{}", particles,
                  vessel.volume_between(0.0, top - left) * fraction / mean_volume(scene),
                  vessel.is_mesh() ? " below its top (a prism that was read ends at its H_d: ask of its file)" : ""));
}

// Area of the floor on which the scene's height takes so many particles.
double fit_floor(const scene::Scene& scene, double particles, double fraction) {
  if (insertion_alone(scene.in)) return particles * mean_volume(scene) / (fraction * scene.container.height());
  if (scene.in.layers.region == input::RegionRule::container) {
    return particles * mean_volume(scene) / (fraction * scene::height_below(scene, scene.container.height()));
  }
  const double layers = static_cast<double>(scene::expected_layers(scene, fraction));
  const double a_layer = particles / layers - margin;
  if (!(a_layer > 0.0)) {
    refuse(fmt::format("{} particles are less than one for each of {:.0f} layers; lower the height or thicken layers",
                       particles, layers));
  }
  return a_layer * mean_volume(scene) / (scene.in.layers.fraction * scene.in.layers.thickness);
}

std::string list(const std::vector<double>& numbers) {
  std::string text;
  for (const double x : numbers) text += fmt::format("{}{}", text.empty() ? "" : ",", tables::number(x));
  return fmt::format("[{}]", text);
}

scene::Scene changed(const Source& source, const std::vector<std::string>& sets) { return scene::build(source(sets)); }

// A prism, or a vessel with obstacles, is a mesh that ends at H_d, wherever that is; one from a file ends where it
// does.
bool grows_with_height(const Source& source, const scene::Scene& scene) {
  if (!scene.container.is_mesh()) return false;
  try {
    const scene::Scene higher =
        changed(source, {"container.height=" + tables::number(2.0 * scene.in.container.size.back())});
    return higher.container.interior->high()[2] > scene.container.interior->high()[2];
  } catch (const Error&) {  // higher than the file's surface
    return false;
  }
}

// Of other vessels only the height is found.
std::string size_key(const scene::Scene& scene, const std::vector<double>& size) {
  return has_size(scene.container) ? "container.size=" + list(size) : "container.height=" + tables::number(size.back());
}

// What is asked for, once it is clear that it is one thing.
Unknown unknown_of(const Question& question, int lateral_axes) {
  const auto open = std::ranges::count_if(question.sides, [](const auto& side) { return !side; });
  if (!question.sides.empty() && std::ssize(question.sides) != lateral_axes) {
    refuse(fmt::format("--floor: {} side{} given, the scene has {}", question.sides.size(),
                       question.sides.size() == 1 ? "" : "s", lateral_axes));
  }
  if (!question.particles) {
    if (open > 0) refuse("--floor: an open side is found for a number of particles; give --particles N");
    return Unknown::particles;
  }
  if (open > 0) return Unknown::floor;
  if (!question.height) return Unknown::height;
  if (!question.sides.empty()) {
    refuse("--particles, --height and --floor leave nothing to find; leave one of them out, or a side of --floor open");
  }
  return Unknown::floor;
}

std::string thickness_key(double thickness) { return "layers.thickness=" + tables::number(thickness); }

// Lateral sides with the area asked for, of those that have the area `now`: the open ones, or all, are scaled alike.
void scale_floor(const Question& question, double area, double now, std::vector<double>& size) {
  const std::size_t axes = size.size() - 1;
  std::vector<std::size_t> open;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    if (question.sides.empty() || !question.sides[axis]) open.push_back(axis);
  }
  const double factor = open.size() == 2 ? std::sqrt(area / now) : area / now;
  for (const std::size_t axis : open) size[axis] *= factor;
}

// Of the heights that take as many layers as this scene's the middle one: where an error of the solid fraction does not
// make one layer more or less.
double middle_height(const Source& source, const Question& question, const scene::Scene& scene) {
  constexpr double step = 0.01, most = 0.5;
  const std::string thickness = thickness_key(scene.in.layers.thickness);
  const double fraction = fraction_of(scene, question).value;
  const std::int64_t layers = scene::expected_layers(scene, fraction);
  std::array<double, 2> ends{1.0, 1.0};  // shares of the height
  for (const std::size_t end : {0U, 1U}) {
    for (double way = step; way < most; way += step) {
      const double share = 1.0 + (end == 0 ? -way : way);
      std::vector<double> size = scene.in.container.size;
      size.back() *= share;
      const scene::Scene other = changed(source, {size_key(scene, size), thickness});
      if (scene::expected_layers(other, fraction) != layers) break;
      ends[end] = share;
    }
  }
  return 0.5 * (ends[0] + ends[1]) * scene.in.container.size.back();
}

// Of thicknesses of layers within a fifth of the scene's that with which whole layers hold the number nearest to the
// one asked for, where the bed is a little denser or looser, too.
scene::Scene with_whole_layers(const Source& source, const Question& question, const scene::Scene& scene) {
  constexpr double widest = 0.2, step = 0.02;
  const auto wanted = static_cast<double>(*question.particles);
  const double thickness = changed(source, {}).in.layers.thickness, least = 2.0 * scene.sizes.largest();
  double best = HUGE_VAL;
  scene::Scene nearest = scene;
  for (double share = 1.0 - widest; share < 1.0 + widest + 0.5 * step; share += step) {
    if (!(share * thickness >= least)) continue;
    scene::Scene one = changed(source, {size_key(scene, scene.in.container.size), thickness_key(share * thickness)});
    const scene::BedFraction fraction = fraction_of(one, question);
    double worst = 1e-6 * wanted * std::abs(share - 1.0);  // of equals that nearest to the scene's
    for (const double shift : {-0.5, 0.0, 0.5}) {
      const scene::Filling filling = scene::expected_filling(one, fraction.value + shift * fraction.error);
      worst = std::max(worst, std::abs(static_cast<double>(filling.particles) - wanted));
    }
    if (worst < best) best = worst, nearest = std::move(one);
  }
  return nearest;
}

// The same of a vessel whose layers differ, where its height is in the middle of those with so many layers.
scene::Scene layered(const Source& source, const Question& question, scene::Scene scene) {
  for (int turn = 0; turn < 3; ++turn) {
    scene = with_whole_layers(source, question, scene);
    std::vector<double> size = scene.in.container.size;
    size.back() = middle_height(source, question, scene);
    scene = changed(source, {size_key(scene, size), thickness_key(scene.in.layers.thickness)});
  }
  return with_whole_layers(source, question, scene);
}

}  // namespace

scene::Scene solved(const Source& source, const Question& question, Unknown& unknown) {
  scene::Scene scene = changed(source, {});
  std::vector<double> size = scene.in.container.size;
  if (question.particles && scene.in.particles.count > 0) {
    refuse(fmt::format("--particles: the scene has particles.count = {}; leave one of them out",
                       scene.in.particles.count));
  }
  unknown = unknown_of(question, scene.container.lateral_axes());
  if (!has_size(scene.container) && (unknown == Unknown::floor || !question.sides.empty())) {
    refuse(
        "the floor is found of a box or a cylinder; of this vessel the height is (--particles N), or give its lengths "
        "themselves (--set container.diameter=...)");
  }
  if (question.height) size.back() = *question.height;
  for (std::size_t axis = 0; axis < question.sides.size(); ++axis)
    size[axis] = question.sides[axis].value_or(size[axis]);
  if (size != scene.in.container.size) scene = changed(source, {size_key(scene, size)});
  if (unknown == Unknown::particles) return scene;
  const auto particles = static_cast<double>(*question.particles);
  if (unknown == Unknown::floor) {
    for (int turn = 0; turn < turns; ++turn) {
      const double area = fit_floor(scene, particles, fraction_of(scene, question).value);
      scale_floor(question, area, scene.container.mean_area(), size);
      scene = changed(source, {size_key(scene, size)});
    }
    return scene;
  }
  if (scene.in.layers.region == input::RegionRule::container || !scene.container.straight() ||
      insertion_alone(scene.in)) {
    const bool grows = grows_with_height(source, scene);
    for (int turn = 0; turn < turns; ++turn) {
      size.back() = fit_extent(scene, grows, particles, fraction_of(scene, question).value);
      scene = changed(source, {size_key(scene, size)});
    }
    return fits_thickness(scene) ? layered(source, question, std::move(scene)) : scene;
  }
  const double layers = std::max(1.0, std::round(particles / static_cast<double>(scene::particles_a_layer(scene))));
  for (int turn = 0; turn < turns; ++turn) {
    const Fitted fitted = fit_height(scene, particles, layers, fraction_of(scene, question).value);
    if (fitted.thickness < 2.0 * scene.sizes.largest()) {
      refuse(
          fmt::format("{} particles are less than a layer on this floor; make the floor smaller (--floor)", particles));
    }
    size.back() = fitted.height;
    scene = changed(source, {size_key(scene, size), thickness_key(fitted.thickness)});
  }
  return scene;
}

}  // namespace packmpi::forecast
