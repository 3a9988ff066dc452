// MercuryDPM: a .data file (format 14 in 3D, 8 in 2D) and a driver that reads it with the scene's law.
#include <fmt/compile.h>

#include <tuple>

#include "exporters/document.hpp"
#include "exporters/law.hpp"
#include "exporters/quote.hpp"

namespace packmpi::exporters::mercurydpm {
namespace {

std::string head(const Specimen& s) {
  const auto box = inner_box(s);
  if (s.flat()) {
    return fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", s.count, s.duration, box[0].low, box[1].low,
                       box[0].high, box[1].high);
  }
  return fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", s.count, s.duration, box[0].low,
                     box[1].low, box[2].low, box[0].high, box[1].high, box[2].high);
}

/// "x y z vx vy vz r ax ay az wx wy wz species"; the angles are 0.
void row_3d(Text& out, const Outgoing& p) {
  const auto& [x, v, w] = std::tie(p.row.position, p.row.velocity, p.row.spin);
  fmt::format_to(
      fmt::appender(out),
      FMT_COMPILE("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 0 0 0 {:.17g} {:.17g} {:.17g} 0\n"), x[0],
      x[1], x[2], v[0], v[1], v[2], p.row.radius, w[0], w[1], w[2]);
}

/// "x y vx vy r angle omega species".
void row_2d(Text& out, const Outgoing& p) {
  const auto& [x, v, w] = std::tie(p.row.position, p.row.velocity, p.row.spin);
  fmt::format_to(fmt::appender(out), FMT_COMPILE("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 0 {:.17g} 0\n"), x[0], x[1],
                 v[0], v[1], p.row.radius, w[2]);
}

std::string species(const Specimen& s) {
  const input::Input& in = s.scene.in;
  const double nu = in.particles.poisson_ratio;
  return fmt::format(
      "  auto* species = problem.speciesHandler.copyAndAddObject(HertzianViscoelasticMindlinSpecies());\n"
      "  species->setDensity({});\n"
      "  species->setEffectiveElasticModulusAndRestitutionCoefficient({}, {});\n"
      "  species->setEffectiveShearModulus({});\n"
      "  species->setSlidingFrictionCoefficient({});\n",
      in.particles.density, in.particles.youngs_modulus / (2.0 * (1.0 - nu * nu)),
      restitution(in.contact.damping_ratio), shear_modulus(s) / (2.0 * (2.0 - nu)), in.contact.friction);
}

std::string walls(const Specimen& s) {
  constexpr const char* normals[] = {"Vec3D({}1.0, 0.0, 0.0)", "Vec3D(0.0, {}1.0, 0.0)", "Vec3D(0.0, 0.0, {}1.0)"};
  const auto along = [&](std::size_t axis, const char* sign) { return fmt::format(fmt::runtime(normals[axis]), sign); };
  std::string text;
  if (s.round()) {
    text = fmt::format(
        "  AxisymmetricIntersectionOfWalls mantle;\n  mantle.setSpecies(species);\n"
        "  mantle.setPosition(Vec3D({0}, {0}, 0.0));\n  mantle.setAxis(Vec3D(0.0, 0.0, 1.0));\n"
        "  mantle.addObject(Vec3D(1.0, 0.0, 0.0), Vec3D({0}, 0.0, 0.0));\n"
        "  problem.wallHandler.copyAndAddObject(mantle);\n",
        s.radius());
  }
  for (std::size_t axis = 0; axis < s.vertical() && !s.round(); ++axis) {
    if (s.periodic(axis)) {
      text += fmt::format("  period.set({}, 0.0, {});\n  problem.boundaryHandler.copyAndAddObject(period);\n",
                          along(axis, ""), s.size[axis]);
    } else {
      text += fmt::format(
          "  wall.set({}, Vec3D(0.0, 0.0, 0.0));\n  problem.wallHandler.copyAndAddObject(wall);\n"
          "  wall.set({}, {} * {});\n  problem.wallHandler.copyAndAddObject(wall);\n",
          along(axis, "-"), along(axis, ""), s.size[axis], along(axis, ""));
    }
  }
  if (const auto& lid = s.scene.container.lid) {
    const std::string up = along(s.vertical(), "");
    text += fmt::format("  wall.set({0}, {1} * {0});\n  problem.wallHandler.copyAndAddObject(wall);\n", up, *lid);
  }
  return text + fmt::format("  wall.set({}, Vec3D(0.0, 0.0, 0.0));\n  problem.wallHandler.copyAndAddObject(wall);\n",
                            along(s.vertical(), "-"));
}

std::string driver(const Specimen& s) {
  const double g = s.scene.in.jamming.gravity;
  std::string text = notes(s, Fluid::not_carried, "// ");
  text += fmt::format(
      "// not carried over: a wall of another stiffness or friction than the particles'\n"
      "// A driver of MercuryDPM: reads the pack and lets it settle for some steps.\n"
      "#include <iostream>\n#include \"Mercury{0}D.h\"\n#include \"Boundaries/PeriodicBoundary.h\"\n"
      "#include \"Species/HertzianViscoelasticMindlinSpecies.h\"\n#include \"Walls/InfiniteWall.h\"\n{1}\n"
      "int main() {{\n  Mercury{0}D problem;\n  problem.setName(\"pack\");\n  problem.setSystemDimensions({0});\n"
      "  problem.setParticleDimensions(3);  // spheres, in a plane too\n",
      s.flat() ? 2 : 3, s.round() ? "#include \"Walls/AxisymmetricIntersectionOfWalls.h\"\n" : "");
  text += species(s);
  text += fmt::format(
      "  problem.setGravity(Vec3D({}));\n"
      "  if (!problem.readDataFile({}, {})) return 1;\n"
      "  InfiniteWall wall;\n  wall.setSpecies(species);\n  PeriodicBoundary period;\n",
      s.flat() ? fmt::format("0.0, {}, 0.0", -g) : fmt::format("0.0, 0.0, {}", -g), cpp_string(s.file),
      s.flat() ? 8 : 14);
  text += walls(s);
  return text + fmt::format(
                    "  std::cout << problem.particleHandler.getNumberOfObjects() << \" particles, mass \" << "
                    "problem.getTotalMass() << \" kg\\n\";\n"
                    "  problem.setTimeStep({0});\n  problem.setTimeMax(problem.getTime() + 200 * {0});\n"
                    "  problem.solve();\n}}\n",
                    s.step());
}

}  // namespace

Document make(const Specimen& s) {
  Document document;
  document.sections.push_back({head(s), s.flat() ? row_2d : row_3d});
  document.companion = driver(s);
  return document;
}

}  // namespace packmpi::exporters::mercurydpm
