// Vessels of triangles: what a particle feels of faces, edges and corners, and packs in them: one on any number of
// ranks and after a stop, none of it outside, as dense as in the shape that the triangles make.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "geometry/volume.hpp"
#include "input/read.hpp"
#include "mesh/shapes.hpp"
#include "run/analyze.hpp"
#include "start/fit.hpp"
#include "support/packs_on_ranks.hpp"

namespace packmpi::run {
namespace {

using testing::Soup;

/// A hopper with a beam and a ball in it, 160 mm wide.
Soup hopper_with_beam() {
  Soup soup = testing::hopper(0.75, 3);
  for (const mesh::Corners& c : testing::box({-0.5, -0.15, 1.0}, {0.5, 0.15, 1.3}, 2)) soup.push_back(c);
  const auto ball = [](const Vec3& x) { return Vec3{0.2 * x[0] + 0.1, 0.2 * x[1] + 0.6, 0.2 * x[2] + 0.9}; };
  for (const mesh::Corners& c : testing::moved(testing::ball(3), ball)) soup.push_back(c);
  return testing::moved(soup, [](const Vec3& x) {
    return Vec3{0.08 * (x[0] + 1.0), 0.08 * (x[1] + 1.0), 0.08 * x[2]};
  });
}

std::string text_of(const Soup& soup, double height, const std::string& more = "") {
  const mesh::Surface surface(soup, "test");
  return "fidelity = \"balanced\"\n[container]\nshape = \"mesh\"\nsurface = \"\"\"\n" +
         mesh::obj_text(surface.shell()) + fmt::format("\"\"\"\nheight = {}\n", height) +
         "[particles]\ndensity = 1000.0\nyoungs_modulus = 5.0e6\npoisson_ratio = 0.25\n"
         "radius = { distribution = \"equal\", value = 0.01 }\n"
         "[layers]\nthickness = 0.08\nfraction = 0.25\n" +
         more +
         "[jamming]\ngravity = 9.81\n"
         "[contact]\nfriction = 0.3\ndamping_ratio = 0.3\n[checkpoint]\nevery = \"off\"\n";
}

class PackInMesh : public test::PacksOnRanks {
 protected:
  static scene::Scene scene_of(const std::string& text) { return scene::build(input::parse(text, "shape.toml", {})); }
};

TEST_F(PackInMesh, IsOneOnAnyNumberOfRanksAndAfterAStop) {
  const scene::Scene scene = scene_of(text_of(hopper_with_beam(), 0.12));
  ASSERT_EQ(run(scene, world_.size(), 0, ""), ExitCode::done) << words_;
  const pack::PackRows first = rows();
  const auto expect_same = [&] {
    const pack::PackRows again = rows();
    EXPECT_EQ(again.position, first.position);
    EXPECT_EQ(again.velocity, first.velocity);
    EXPECT_EQ(again.spin, first.spin);
  };
  EXPECT_EQ(run(scene, 1, 0, ""), ExitCode::done);
  expect_same();
  EXPECT_EQ(run(scene, 1, 700, ""), ExitCode::stopped_early);
  const scene::Scene other = scene_of(text_of(testing::moved(hopper_with_beam(),
                                                             [](const Vec3& x) {
                                                               return Vec3{x[0], x[1], 1.01 * x[2]};
                                                             }),
                                              0.12));
  EXPECT_EQ(run(other, 2, 0, "auto"), ExitCode::bad_checkpoint);
  if (world_.rank() == 0) {
    EXPECT_NE(words_.find("container.surface: a mesh of "), std::string::npos) << words_;
  }
  EXPECT_EQ(run(scene, 2, 0, "auto"), ExitCode::done);
  expect_same();
  // Inside, all of it; and full.
  const geometry::Container& vessel = scene.container;
  ASSERT_GT(first.id.size(), 120U);
  double solid = 0.0;
  for (std::size_t k = 0; k < first.id.size(); ++k) {
    EXPECT_GT(vessel.interior->nearest(first.position[k]).distance, 0.97 * first.radius[k]) << k;
    solid += geometry::volume_below(3, first.radius[k], first.position[k][2], vessel.height());
  }
  if (world_.rank() != 0) return;
  EXPECT_EQ(record_.audit.outside, 0);
  EXPECT_NEAR(record_.phi, solid / vessel.volume_between(0.0, vessel.height()), 1e-9);
  EXPECT_GT(record_.phi_bulk, 0.45);  // few diameters wide
  EXPECT_LT(record_.phi_bulk, 0.62);
  EXPECT_NEAR(record_.rest.support, 1.0, 0.05);
}

/// A pack in a mesh is gone on with in that very surface, filled higher.
TEST_F(PackInMesh, GoesOnFromAPackInIt) {
  (void)run(scene_of(text_of(hopper_with_beam(), 0.08)), world_.size(), 0, "");
  const std::size_t before = rows().id.size();
  const auto next = [&](double width) {
    const Soup soup = testing::moved(hopper_with_beam(), [&](const Vec3& x) { return Vec3{width * x[0], x[1], x[2]}; });
    const std::string text = text_of(soup, 0.12) + "[start]\npack = \"" + folder_ + "/shape.hdf\"\n";
    return scene::build(start::with_start(world_, input::parse(text, folder_ + "/next.toml", {})));
  };
  ASSERT_EQ(run(next(1.0), world_.size(), 0, ""), ExitCode::done) << words_;
  EXPECT_GT(static_cast<std::size_t>(record_.particles), before + 50);
  EXPECT_EQ(record_.audit.outside, 0);
  EXPECT_NE(record_.start.find("shape.hdf"), std::string::npos) << record_.start;
  EXPECT_EQ(run(next(1.01), world_.size(), 0, ""), ExitCode::bad_input);
  if (world_.rank() == 0) {
    EXPECT_NE(words_.find("a mesh of another surface than the scene's"), std::string::npos) << words_;
  }
}

/// A box given by triangles or as a prism is the box, but for rounding; what that does later is chance.
TEST_F(PackInMesh, ABoxOfTrianglesIsTheBox) {
  const std::string more =
      "maximum = 1\nduration = 0.02\nregion = \"container\"\n[rest]\nwait = 0\n[dynamics]\nrelaxation = 0\n";
  const std::string text = text_of(testing::box({0, 0, 0}, {0.16, 0.12, 0.3}, 4), 0.2, more);
  const std::size_t from = text.find("shape ="), length = text.find("[particles]") - from;
  const auto with = [&](const char* container) { return scene_of(std::string(text).replace(from, length, container)); };
  const scene::Scene of_box = with("size = [0.16, 0.12, 0.2]\n");
  (void)run(of_box, world_.size(), 0, "");
  const pack::PackRows b = rows();
  const double fraction = record_.phi;
  EXPECT_GT(b.id.size(), 80U);
  for (const scene::Scene& of_mesh :
       {scene_of(text), with("shape = \"prism\"\nheight = 0.2\n"  // the other way round, and elsewhere
                             "polygon = [[1, 1], [1, 1.12], [\"1160 mm\", 1.12], [1.16, 1]]\n")}) {
    EXPECT_NEAR(of_mesh.container.volume_between(0.0, 0.2), of_box.container.volume_between(0.0, 0.2), 1e-15);
    (void)run(of_mesh, world_.size(), 0, "");
    const pack::PackRows a = rows();
    EXPECT_NEAR(fraction, record_.phi, 1e-9);
    ASSERT_EQ(a.id.size(), b.id.size());
    for (std::size_t k = 0; k < a.id.size(); ++k) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a.position[k][c], b.position[k][c], 1e-9);
    }
  }
}

/// Against points of another source, whose distance from the six sides is known.
TEST_F(PackInMesh, ItsSolidFractionIsToldByTheDistanceFromTheWalls) {
  const Vec3 size{0.16, 0.12, 0.2};
  ASSERT_EQ(run(scene_of(text_of(testing::box({0, 0, 0}, size, 2), 0.1, "[rest]\nwait = 0\n")), world_.size(), 0, ""),
            ExitCode::done)
      << words_;
  (void)analyze(world_, folder_ + "/shape.hdf");
  world_.barrier();
  std::ifstream file(folder_ + "/shape.analysis.json");
  const nlohmann::json found = nlohmann::json::parse(file)["radial_profile"];
  const std::vector<double> values = found["from_wall"]["values"];
  const double width = found["from_wall"]["width"];
  ASSERT_GT(values.size(), 40U);
  EXPECT_EQ(found["from_wall"]["from"], 0.0);
  EXPECT_NEAR(width, 0.001, 1e-12);
  const pack::PackRows pack = rows();
  const auto& bulk = record_.bulk;
  std::vector<int> interior(values.size(), 0), solid(values.size(), 0);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u;
  for (int k = 0; k < 60000; ++k) {
    const Vec3 x{u(random) * size[0], u(random) * size[1], bulk.low + u(random) * (bulk.high - bulk.low)};
    const double away = std::min({x[0], size[0] - x[0], x[1], size[1] - x[1], x[2], size[2] - x[2]});
    const auto shell = static_cast<std::size_t>(away / width);
    if (shell >= values.size()) continue;
    ++interior[shell];
    for (std::size_t i = 0; i < pack.id.size(); ++i) {
      const Vec3& c = pack.position[i];
      solid[shell] += std::hypot(x[0] - c[0], x[1] - c[1], x[2] - c[2]) < pack.radius[i] ? 1 : 0;
    }
  }
  double most = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (interior[k] < 100) continue;
    const double share = static_cast<double>(solid[k]) / interior[k];
    const double error = std::sqrt(std::max(share * (1.0 - share), 0.05) / interior[k]);
    EXPECT_NEAR(values[k], share, 4.5 * error) << "shell " << k;
    most = std::max(most, values[k]);
  }
  EXPECT_GT(most, 0.6) << "a layer of spheres stands at the walls";
  EXPECT_LT(values[0], 0.25);
}

/// Obstacles in a cylinder: the vessel has facets then, and nothing is in a ball, in a bar, or outside.
TEST_F(PackInMesh, ObstaclesAreLeftOut) {
  std::string text = text_of(testing::box({0, 0, 0}, {1, 1, 1}), 0.2, "maximum = 2\n");
  const std::size_t from = text.find("shape ="), length = text.find("[particles]") - from;
  text.replace(from, length, "shape = \"cylinder\"\ndiameter = 0.16\nheight = 0.2\n");
  text +=
      "[[obstacle]]\nshape = \"sphere\"\ndiameter = 0.06\nposition = [0.08, 0.08, 0.032]\n"
      "[[obstacle]]\nshape = \"cylinder\"\ndiameter = 0.02\naxis = \"x\"\nlength = 0.1\nposition = [0.08, 0.1, 0.08]\n";
  const scene::Scene scene = scene_of(text);
  ASSERT_EQ(run(scene, world_.size(), 0, ""), ExitCode::done) << words_;
  const pack::PackRows first = rows();
  EXPECT_EQ(run(scene, 1, 0, ""), ExitCode::done);
  EXPECT_EQ(rows().position, first.position);
  EXPECT_EQ(record_.audit.outside, 0);
  ASSERT_GT(first.id.size(), 100U);
  std::size_t on_ball = 0;
  for (std::size_t k = 0; k < first.id.size(); ++k) {
    const Vec3& x = first.position[k];
    const double r = 0.97 * first.radius[k];
    const double from_ball = norm(mesh::minus(x, {0.08, 0.08, 0.032})) - 0.03;
    EXPECT_GT(from_ball, r) << k;
    on_ball += static_cast<std::size_t>(from_ball < 1.001 * first.radius[k]);
    EXPECT_LT(std::hypot(x[0] - 0.08, x[1] - 0.08), 0.08 - r) << k;
    const bool beside = x[0] > 0.03 && x[0] < 0.13;
    EXPECT_TRUE(!beside || std::hypot(x[1] - 0.1, x[2] - 0.08) - 0.01 > r) << k;
  }
  EXPECT_GT(on_ball, 5U);
}

}  // namespace
}  // namespace packmpi::run
