// Packs in the formats of other codes: the same bytes on any number of ranks, and every number of the pack in them.
#include "exporters/convert.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>

#include "exporters/law.hpp"
#include "exporters/yade_walls.hpp"
#include "geometry/cut_volume.hpp"
#include "geometry/round_volume.hpp"
#include "input/read.hpp"
#include "mesh/shapes.hpp"
#include "pack/samples.hpp"

namespace packmpi::exporters {
using namespace disk;
using namespace report;
using namespace pack;
namespace {

using testing::Folder;
using testing::Grain;
using testing::Spread;

std::string scene_text(int dimension, const std::string& boundary) {
  return fmt::format(
      "seed = 7\n[container]\ndimension = {}\nsize = [{}10.0, 0.6]\nboundary = [{}]\n"
      "[particles]\ndensity = 2000.0\nyoungs_modulus = 1e8\npoisson_ratio = 0.25\n"
      "radius = {{ distribution = \"uniform\", min = 0.0005, max = 0.102, weighting = \"number\" }}\n"
      "[layers]\nthickness = 0.3\nfraction = 0.1\nduration = 1.0\n[jamming]\ngravity = 2.0\n",
      dimension, dimension == 3 ? "12.0, " : "", boundary);
}

class Convert : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  comm::Comm alone_{MPI_COMM_SELF};
  Folder folder_{comm_};
  confine::Outcome confined_ = {};  ///< of the packs that are made
  double motion_ = 0.0;             ///< their kinetic energy over weight times diameter; 0: some

  /// A pack of made-up particles in folder_; its path.
  std::string make_pack(std::size_t count, int dimension, const std::string& boundary) {
    return make_pack_of(count, dimension, scene_text(dimension, boundary));
  }
  /// With those contacts for which `keep` holds, and walls; none: without any.
  std::string make_pack_of(std::size_t count, int dimension, const std::string& scene,
                           const std::function<bool(const ContactRow&)>& keep = {}) {
    std::vector<Grain> grains = testing::some_grains(count, dimension);
    for (Grain& g : grains) g.r *= 0.1;
    auto parts = testing::make_parts(comm_, particles::layout_of(dimension, true), grains, Spread::some);
    if (keep) std::erase_if(parts.rows, std::not_fn(keep));
    RunRecord record = testing::some_record(dimension, 1);
    record.effective_input = input::parse(scene, "scene", {}).effective;
    record.seed = 7;
    if (motion_ > 0.0) {
      record.weight = 3.0;
      record.kinetic_energy = motion_ * 3.0 * 2.0 * scene::build(input::parse(scene, "scene", {})).sizes.mean();
    }
    record.confined = confined_;
    const std::string path = folder_.file("sample.hdf");
    write_pack(comm_, path, parts.view(static_cast<bool>(keep)), record);
    return path;
  }

  std::string subfolder(const std::string& name) {
    if (comm_.rank() == 0) std::filesystem::create_directory(folder_.file(name));
    comm_.barrier();
    return folder_.file(name);
  }

  [[nodiscard]] std::size_t files_in(const std::string& folder) const {
    comm_.barrier();
    const auto n = static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
    comm_.barrier();
    return n;
  }

  /// The words of the error that every rank is to throw with `code`.
  std::string refused(const ConvertRequest& request, ExitCode code) {
    std::string words;
    try {
      convert_pack(comm_, request);
    } catch (const Error& error) {
      words = error.what();
      EXPECT_EQ(error.code(), code) << words;
    }
    EXPECT_FALSE(words.empty());
    EXPECT_EQ(words, comm_.broadcast(0, words));
    return words;
  }
};

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

bool contains(const std::string& words, const std::string& part) { return words.find(part) != std::string::npos; }

constexpr const char* both_periodic = "\"periodic\", \"periodic\"";

TEST_F(Convert, SameBytesOnAnyNumberOfRanks) {
  struct Case {
    int dimension;
    const char* boundary;
    Trim trim;
    std::array<int, 2> copies;
    const char* cut = "";
  };
  const std::string here = subfolder("here");
  const std::string one = subfolder("one");
  for (const Case& c : {Case{3, both_periodic, Trim::none, {1, 1}}, Case{3, both_periodic, Trim::cut, {2, 3}},
                        Case{2, "\"wall\"", Trim::drop, {1, 1}}, Case{2, "\"periodic\"", Trim::none, {3, 1}},
                        Case{3, both_periodic, Trim::none, {1, 1}, "cylinder:diameter=1,x=0.5,y=0.5"}}) {
    const std::string pack = make_pack(1001, c.dimension, c.boundary);
    for (const FormatWords& format : convert_formats()) {
      ConvertRequest request{.pack = pack,
                             .format = format.name,
                             .file = here + "/a" + format.ending,
                             .trim = c.trim,
                             .cut = c.cut,
                             .copies = c.copies,
                             .force = true};
      const Converted done = convert_pack(comm_, request);
      EXPECT_EQ(done.files.size(), *format.companion == '\0' ? 1u : 2u);
      if (comm_.rank() != 0) continue;
      request.file = one + "/a" + format.ending;
      const Converted serial = convert_pack(alone_, request);
      EXPECT_EQ(done.particles, serial.particles);
      EXPECT_EQ(done.volume, serial.volume);
      EXPECT_EQ(done.cut_fraction, serial.cut_fraction);
      for (std::size_t f = 0; f < done.files.size(); ++f) {
        EXPECT_GT(contents(done.files[f]).size(), 100u);
        EXPECT_TRUE(contents(done.files[f]) == contents(serial.files[f])) << done.files[f];
      }
    }
    comm_.barrier();
  }
  EXPECT_EQ(files_in(here), 17u);  // ten files, seven of them with a companion, and no temporary
}

// In which small particles weigh enough for their forces to be summed.
std::string with_memory() {
  std::string text = scene_text(3, both_periodic) + "[contact]\nfriction = 0.5\ntangential = \"mindlin\"\n";
  const std::string gravity = "gravity = 2.0";
  return text.replace(text.find(gravity), gravity.size(), "gravity = 2000.0");
}

// One contact a particle leaves every spring a motion.
TEST_F(Convert, SpringsGoAlongWithTheSameBytesOnAnyNumberOfRanks) {
  const std::string pack =
      make_pack_of(301, 3, with_memory(), [](const ContactRow& row) { return row.second == row.first + 1; });
  const std::string here = subfolder("here"), one = subfolder("one");
  for (const char* name : {"lammps", "liggghts", "yade"}) {
    ConvertRequest request{.pack = pack, .format = name, .file = here + "/" + name + ".data"};
    const Converted done = convert_pack(comm_, request);
    EXPECT_TRUE(done.springs.starts_with("carried over")) << done.springs;
    EXPECT_EQ(done.files.size(), std::string(name) == "yade" ? 3U : 2U);
    if (comm_.rank() != 0) continue;
    request.file = one + "/" + name + ".data";
    const Converted serial = convert_pack(alone_, request);
    for (std::size_t f = 0; f < done.files.size(); ++f) {
      EXPECT_TRUE(contents(done.files[f]) == contents(serial.files[f])) << done.files[f];
    }
    const std::string script = contents(done.files[1]);
    EXPECT_NE(script.find(done.files.size() == 3U ? "shearElastic" : "timestep        1000\nrun             1\n"),
              std::string::npos);
  }
  comm_.barrier();
}

// Whether the pack is at rest is asked of the whole of it, not of the part or the copies that are written.
TEST_F(Convert, APartOfAPackIsAtRestAsTheWholeIs) {
  for (const bool rests : {true, false}) {
    motion_ = rests ? 0.9e-4 : 1.1e-4;
    const std::string pack =
        make_pack_of(301, 3, with_memory(), [](const ContactRow& row) { return row.second == row.first + 1; });
    for (const Trim trim : {Trim::none, Trim::drop, Trim::cut}) {
      const Converted done = convert_pack(comm_, {.pack = pack, .format = "lammps", .trim = trim, .force = true});
      EXPECT_EQ(done.particles < done.of, trim != Trim::none);
      EXPECT_TRUE(done.springs.starts_with(rests ? "carried over" : "not carried over, as the pack moves"))
          << done.springs;
    }
  }
}

// Of more contacts than motions: velocities are the pack's, and the script makes no springs.
TEST_F(Convert, SpringsThatNoMotionMakesStayBehindAndItIsSaid) {
  const std::string pack = make_pack_of(301, 3, with_memory(), [](const ContactRow&) { return true; });
  const std::string bare = subfolder("bare") + "/bare.data", many = subfolder("many") + "/bare.data";
  const Converted done = convert_pack(comm_, {.pack = pack, .format = "lammps", .file = many});
  EXPECT_TRUE(done.springs.starts_with("not carried over, as no motion makes all of them")) << done.springs;
  const std::string without = make_pack_of(301, 3, with_memory());  // the same pack
  EXPECT_TRUE(
      convert_pack(comm_, {.pack = without, .format = "lammps", .file = bare}).springs.find("output.contacts") !=
      std::string::npos);
  if (comm_.rank() != 0) return;
  EXPECT_TRUE(contents(many) == contents(bare));
  EXPECT_EQ(contents(done.files[1]).find("timestep        1000"), std::string::npos);
}

/// Numbers of a CSV file, row by row.
std::vector<std::vector<double>> rows_of(const std::string& path) {
  std::istringstream file(contents(path));
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#') || line.starts_with("id")) continue;
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

/// A row as it must be.
std::vector<double> expected_row(const PackRows& pack, std::size_t k, std::int64_t id, const Vec3& shift) {
  const Vec3& x = pack.position[k];
  const Vec3& v = pack.velocity[k];
  const Vec3& w = pack.spin[k];
  return {static_cast<double>(id),
          x[0] + shift[0],
          x[1] + shift[1],
          x[2] + shift[2],
          pack.radius[k],
          v[0],
          v[1],
          v[2],
          w[0],
          w[1],
          w[2],
          static_cast<double>(pack.layer[k]),
          static_cast<double>(pack.contacts[k])};
}

TEST_F(Convert, EveryNumberOfThePackInManyBatches) {
  const std::string path = make_pack(40000, 3, both_periodic);
  const Converted done = convert_pack(comm_, {.pack = path, .format = "csv"});
  EXPECT_EQ(done.files, std::vector<std::string>{folder_.file("sample.csv")});
  EXPECT_EQ(done.particles, 40000);
  if (comm_.rank() != 0) return;
  const PackRows pack = read_pack(path);
  const auto rows = rows_of(done.files[0]);
  ASSERT_EQ(rows.size(), 40000u);
  double volume = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_EQ(rows[k], expected_row(pack, k, static_cast<std::int64_t>(k) + 1, {})) << k;
    volume += 4.0 / 3.0 * 3.14159265358979323846 * std::pow(pack.radius[k], 3);
  }
  EXPECT_NEAR(done.volume, volume, 1e-8 * volume);
  EXPECT_TRUE(contains(contents(done.files[0]), "# 40000 spheres of sample.hdf (made by packmpi 0.1.0), seed 7;"));
}

TEST_F(Convert, TrimmedAndReplicatedParticlesAreTheRightOnes) {
  const std::string path = make_pack(500, 3, both_periodic);
  const PackRows pack = read_pack(path);
  for (const Trim trim : {Trim::none, Trim::drop, Trim::cut}) {
    const Converted done =
        convert_pack(comm_, {.pack = path, .format = "csv", .trim = trim, .copies = {2, 2}, .force = true});
    std::vector<std::vector<double>> expected;
    for (int copy = 0; copy < 4; ++copy) {
      for (std::size_t k = 0; k < pack.id.size(); ++k) {
        const double level = pack.position[k][2] + (trim == Trim::drop ? pack.radius[k] : 0.0);
        if (trim != Trim::none && level > 0.6) continue;
        const Vec3 shift{copy % 2 * 12.0, copy / 2 * 10.0, 0.0};
        expected.push_back(expected_row(pack, k, 500 * copy + static_cast<std::int64_t>(k) + 1, shift));
      }
    }
    EXPECT_EQ(done.particles, static_cast<std::int64_t>(expected.size()));
    if (comm_.rank() == 0) {
      EXPECT_TRUE(rows_of(done.files[0]) == expected);
      EXPECT_TRUE(contains(contents(done.files[0]), "# replicated: 2 x 2 copies"));
      EXPECT_EQ(contains(contents(done.files[0]), "# trimmed:"), trim != Trim::none);
    }
    comm_.barrier();
  }
}

/// A specimen: which spheres are wholly in it, and how much of one is.
struct Specimens {
  const char* words;
  Vec3 low;
  double volume;
  std::function<bool(const Vec3&, double)> holds;
  std::function<double(const Vec3&, double)> part;
};

// Spheres of the pack, and their images beyond its periodic sides, by the definition.
TEST_F(Convert, ASpecimenThatIsCutOutHasWhatIsInIt) {
  const std::string path = make_pack(3000, 3, both_periodic);
  const PackRows pack = read_pack(path);
  const double pi = 3.14159265358979323846;
  const auto out = [](double x, double middle) { return std::abs(x - middle); };
  const std::vector<Specimens> all{
      {"cylinder:diameter=100cm,height=0.4,x=0.6,y=0.5,z=0.3",
       {0.1, 0.0, 0.1},
       pi * 0.25 * 0.4,
       [&](const Vec3& x, double r) {
         return std::hypot(x[0] - 0.6, x[1] - 0.5) + r <= 0.5 && out(x[2], 0.3) + r <= 0.2;
       },
       [](const Vec3& x, double r) {
         return geometry::volume_in_cylinder(r, std::hypot(x[0] - 0.6, x[1] - 0.5), 0.5, 0.1 - x[2], 0.5 - x[2]);
       }},
      {"box:height=0.4,z=0.2",
       {0.0, 0.0, 0.0},
       12.0 * 10.0 * 0.4,
       [&](const Vec3& x, double r) {
         return out(x[0], 6.0) + r <= 6.0 && out(x[1], 5.0) + r <= 5.0 && out(x[2], 0.2) + r <= 0.2;
       },
       [](const Vec3& x, double r) {
         return geometry::volume_in_box(r, {-x[0], -x[1], -x[2]}, {12.0 - x[0], 10.0 - x[1], 0.4 - x[2]});
       }},
      {"sphere:diameter=0.6,x=0.5,y=0.5",
       {0.2, 0.2, 0.0},
       pi * 0.036,
       [&](const Vec3& x, double r) { return std::hypot(x[0] - 0.5, x[1] - 0.5, x[2] - 0.3) + r <= 0.3; },
       [](const Vec3& x, double r) {
         return geometry::volume_in_sphere(r, std::hypot(x[0] - 0.5, x[1] - 0.5, x[2] - 0.3), 0.3);
       }}};
  for (const Specimens& one : all) {
    const Converted done = convert_pack(comm_, {.pack = path, .format = "csv", .cut = one.words, .force = true});
    std::vector<std::vector<double>> expected;
    long double solid = 0.0L;
    for (std::size_t k = 0; k < pack.id.size(); ++k) {
      const double r = pack.radius[k];
      if (one.holds(pack.position[k], r)) {
        expected.push_back(expected_row(pack, k, static_cast<std::int64_t>(k) + 1, {}));
        for (std::size_t a = 0; a < 3; ++a) expected.back()[a + 1] -= one.low[a];
      }
      for (int image = 0; image < 9; ++image) {
        Vec3 x = pack.position[k];
        x[0] += 12.0 * (image % 3 - 1), x[1] += 10.0 * (image / 3 - 1);
        solid += one.part(x, r);
      }
    }
    EXPECT_GT(expected.size(), 20U);
    EXPECT_EQ(done.particles, static_cast<std::int64_t>(expected.size())) << one.words;
    EXPECT_NEAR(done.cut_fraction, static_cast<double>(solid) / one.volume, 1e-9) << one.words;
    EXPECT_GT(done.cut_fraction, 0.0);
    if (comm_.rank() == 0) {
      const auto rows = rows_of(done.files[0]);
      ASSERT_EQ(rows.size(), expected.size());
      for (std::size_t k = 0; k < rows.size(); ++k) {
        for (std::size_t c = 0; c < rows[k].size(); ++c) ASSERT_NEAR(rows[k][c], expected[k][c], 1e-14) << one.words;
      }
      EXPECT_TRUE(contains(contents(done.files[0]), "# cut out of the pack: a "));
      EXPECT_FALSE(contains(contents(done.files[0]), "periodic"));
    }
    comm_.barrier();
  }
  const Converted whole = convert_pack(comm_, {.pack = path, .format = "lammps", .cut = all[0].words, .force = true});
  EXPECT_TRUE(contains(contents(whole.files.at(1)), "region          mantle cylinder z 0.5 0.5 0.5 INF INF side in"));
}

void write_file(const comm::Comm& comm, const std::string& path, const std::string& bytes) {
  if (comm.rank() == 0) std::ofstream(path, std::ios::binary) << bytes;
  comm.barrier();
}

/// An L in centimetres, across a periodic side: particles wholly inside, and what of all is.
TEST_F(Convert, ASpecimenInASurfaceOfAFile) {
  const std::string path = make_pack(3000, 3, both_periodic);
  const std::string l = folder_.file("l.stl");
  write_file(comm_, l, mesh::binary_stl(testing::moved(testing::l_prism(0.5, 3), [](const Vec3& x) {
               return Vec3{50.0 * x[0], 50.0 * x[1] - 100.0, 100.0 * x[2] + 5.0};
             })));
  const PackRows pack = read_pack(path);
  const std::array<std::array<Vec3, 2>, 2> boxes{
      {{{{0.0, 0.0, 0.05}, {1.0, 0.5, 0.55}}}, {{{0.0, 0.5, 0.05}, {0.5, 1.0, 0.55}}}}};  // both parts of the L
  std::vector<std::int64_t> ids;
  double solid = 0.0;
  for (std::size_t k = 0; k < pack.id.size(); ++k) {
    const double r = pack.radius[k];
    const Vec3& x = pack.position[k];
    const bool in_arms = (x[0] >= r && x[1] >= r && x[0] <= 1.0 - r && x[1] <= 0.5 - r) ||
                         (x[0] >= r && x[1] >= r && x[0] <= 0.5 - r && x[1] <= 1.0 - r);
    const bool at_corner =
        x[0] <= 0.5 && x[1] <= 0.5 && x[0] >= r && x[1] >= r && std::hypot(0.5 - x[0], 0.5 - x[1]) >= r;
    if ((in_arms || at_corner) && x[2] >= 0.05 + r && x[2] <= 0.55 - r) ids.push_back(static_cast<std::int64_t>(k) + 1);
    for (int image = 0; image < 9; ++image) {
      const Vec3 at{x[0] + 12.0 * (image % 3 - 1), x[1] + 10.0 * (image / 3 - 1), x[2]};
      for (const auto& [low, high] : boxes) {
        solid += geometry::volume_in_box(r, mesh::minus(low, at), mesh::minus(high, at));
      }
    }
  }
  const Converted done =
      convert_pack(comm_, {.pack = path, .format = "csv", .cut = l + ":unit=cm,x=0.5,y=50cm", .force = true});
  EXPECT_EQ(done.particles, static_cast<std::int64_t>(ids.size()));
  EXPECT_GT(ids.size(), 10U);
  EXPECT_NEAR(done.cut_fraction, solid / 0.375, 1e-9);
  EXPECT_EQ(done.cut, "the interior of 0.375 m3 inside the 252 triangles of l.stl");
  if (comm_.rank() == 0) {
    const auto rows = rows_of(done.files[0]);
    ASSERT_EQ(rows.size(), ids.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      EXPECT_EQ(rows[k][0], static_cast<double>(ids[k]));
      EXPECT_NEAR(rows[k][3], pack.position[static_cast<std::size_t>(ids[k] - 1)][2] - 0.05, 1e-14);
    }
  }
  comm_.barrier();
  const auto with = [&](const std::string& words) {
    return refused({.pack = path, .format = "csv", .cut = words, .force = true}, ExitCode::bad_input);
  };
  EXPECT_TRUE(contains(with(l + ":unit=cm"), "from -1 to 0 m along y, and the container from 0 to 10 m"));
  EXPECT_TRUE(contains(with(l + ":unit=kg"), "unit is \"kg\"; give one of lengths, such as mm"));
  EXPECT_TRUE(contains(with(l + ":w=1"), "a surface has no \"w\"; there are unit, x, y, z"));
  EXPECT_TRUE(contains(with("no.stl"), "no.stl cannot be opened (No such file"));
  write_file(comm_, folder_.file("open.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\nf 1 3 4\n");
  EXPECT_TRUE(contains(with(folder_.file("open.obj")), "open.obj: the surface is open: 4 edges"));
}

TEST_F(Convert, WallsOfVesselsAreThoseThatACodeHas) {
  const auto pack_in = [&](const std::string& vessel) {
    std::string scene = scene_text(3, "\"wall\", \"wall\"");
    const std::size_t begin = scene.find("dimension"), end = scene.find("[particles]");
    return make_pack_of(100, 3, scene.replace(begin, end - begin, vessel));
  };
  const auto in_file = [&](const std::string& path, const std::string& format) {
    return contents(convert_pack(comm_, {.pack = path, .format = format, .force = true}).files.at(1));
  };
  const std::string hopper = pack_in("shape = \"frustum\"\nbottom_diameter = 6.0\ntop_diameter = 12.0\nheight = 0.6\n");
  const std::string lammps = in_file(hopper, "lammps");
  std::array<double, 4> cone{};  // radii below and above, heights there
  const std::string mark = "region          mantle cone z 6 6 ";
  ASSERT_TRUE(contains(lammps, mark));
  std::istringstream numbers(lammps.substr(lammps.find(mark) + mark.size()));
  for (double& number : cone) numbers >> number;
  const double rise = (cone[1] - cone[0]) / (cone[3] - cone[2]);
  EXPECT_NEAR(rise, 5.0, 1e-12);
  EXPECT_NEAR(cone[0] - rise * cone[2], 3.0, 1e-12);
  EXPECT_LT(cone[2], 0.0);
  EXPECT_GT(cone[3], 0.6);
  EXPECT_TRUE(contains(lammps, "region          collar cylinder z 6 6 6 INF INF side in units box"));
  EXPECT_TRUE(contains(lammps, "region mantle\n") && contains(lammps, "region collar\n"));
  const std::string yade = in_file(hopper, "yade");
  EXPECT_TRUE(contains(yade, "    6: (Vector3(6, 6, 0), 0.58") && contains(yade, "    8: (Vector3(6, 6, 0), 6, 1, "));
  EXPECT_TRUE(contains(yade, "PyRunner(command='push_off_round_walls()', iterPeriod=1, initRun=True)"));
  EXPECT_TRUE(contains(refused({.pack = hopper, .format = "liggghts"}, ExitCode::bad_input), "use lammps or yade, or"));
  const std::string ball = pack_in("shape = \"sphere\"\ndiameter = 10.0\nheight = 0.6\n");
  EXPECT_TRUE(contains(in_file(ball, "lammps"), "region          mantle sphere 5 5 5 5 side in units box"));
  EXPECT_FALSE(contains(in_file(ball, "lammps"), "zplane"));
  EXPECT_TRUE(contains(in_file(ball, "yade"), "    6: (Vector3(5, 5, 5), 5, 1, Vector3(1, 1, 1), "));
  EXPECT_FALSE(contains(in_file(ball, "yade"), "utils.wall("));
  EXPECT_TRUE(contains(refused({.pack = ball, .format = "liggghts"}, ExitCode::bad_input), "use lammps or yade, or"));
  const std::string ring = pack_in("shape = \"annulus\"\ndiameter = 12.0\ninner_diameter = 4.0\nheight = 0.6\n");
  EXPECT_TRUE(contains(in_file(ring, "lammps"), "region          inner cylinder z 6 6 2 INF INF side out units box"));
  EXPECT_TRUE(contains(in_file(ring, "liggghts"), "zcylinder 2 6 6"));
  EXPECT_TRUE(contains(refused({.pack = ring, .format = "pfc"}, ExitCode::bad_input), "lammps or liggghts or yade"));
  EXPECT_TRUE(contains(refused({.pack = ring, .format = "csv", .cut = "cylinder:diameter=2"}, ExitCode::bad_input),
                       "from the axis of the annulus"));
}

// Every code that gets walls gets the lid, too: of a box, of a round vessel and of a mesh.
TEST_F(Convert, ALidIsCarried) {
  confined_.on = true;
  confined_.lid = 9.5;
  confined_.size = confined_.on_sides = {12.0, 12.0};
  confined_.of_contacts = {1.0, 1.0, 1.0};
  const std::string stress = "[contact]\ntangential = \"mindlin\"\n[confinement]\nvertical = 100.0\n";
  const std::map<std::string, std::string> lids{
      {"lammps", "region          lid plane 0 0 9.5 0 0 -1 move"},
      {"liggghts", "wall_zlid all wall/gran"},
      {"yade", "utils.wall(9.5, axis=2, sense=-1"},
      {"pfc", "wall generate plane position 0 0 9.5 dip 0"},
      {"mercurydpm", "wall.set(Vec3D(0.0, 0.0, 1.0), 9.5 * Vec3D(0.0, 0.0, 1.0))"},
      {"lethe", " : 12,12,9.5 : true"}};
  const std::array<std::string, 3> vessels{
      "size = [12.0, 12.0, 0.6]\n", "shape = \"cylinder\"\ndiameter = 12.0\nheight = 0.6\n",
      "shape = \"prism\"\npolygon = [[0, 0], [12, 0], [12, 12], [0, 12]]\nheight = 10\n"};
  for (const std::string& vessel : vessels) {
    SCOPED_TRACE(vessel);
    std::string scene = scene_text(3, "\"wall\", \"wall\"") + stress;
    const std::size_t begin = scene.find("dimension"), end = scene.find("[particles]");
    const std::string pack = make_pack_of(100, 3, scene.replace(begin, end - begin, vessel));
    const bool box = &vessel == &vessels[0], mesh = &vessel == &vessels[2];
    for (const auto& [code, words] : lids) {
      if (mesh && code != "liggghts" && code != "yade") continue;  // the others have no meshes
      if (!box && code == "lethe") continue;                       // nor a cylinder of its own
      const std::string text =
          contents(convert_pack(comm_, {.pack = pack, .format = code, .force = true}).files.at(code == "pfc" ? 0 : 1));
      EXPECT_TRUE(contains(text, words)) << code << "\n" << text;
    }
    const auto refused = [&](const char* code) {
      try {
        (void)convert_pack(comm_, {.pack = pack, .format = code, .trim = Trim::cut, .force = true});
      } catch (const Error& error) {
        return std::string(error.what());
      }
      return std::string();
    };
    EXPECT_TRUE(contains(refused("liggghts"), "--trim: this pack stands under a lid"));
    EXPECT_EQ(refused("csv"), "");
  }
}

// Floor and lid of a polygon are planes of its own in LAMMPS, and each is there once.
TEST_F(Convert, ALidOverAPolygonIsWrittenOnce) {
  confined_.on = true;
  confined_.lid = 9.5;
  confined_.size = confined_.on_sides = {12.0};
  confined_.of_contacts = {1.0, 1.0};
  std::string scene =
      scene_text(2, "\"wall\"") + "[contact]\ntangential = \"mindlin\"\n[confinement]\nvertical = 100.0\n";
  const std::size_t begin = scene.find("dimension"), end = scene.find("[particles]");
  const std::string trapezium =
      "dimension = 2\nshape = \"trapezium\"\nbottom_width = 6.0\ntop_width = 12.0\nheight = 1.0\n";
  const std::string pack = make_pack_of(100, 2, scene.replace(begin, end - begin, trapezium));
  const std::string text = contents(convert_pack(comm_, {.pack = pack, .format = "lammps", .force = true}).files.at(1));
  std::size_t lids = 0;
  for (std::size_t at = text.find(" 9.5 0 0 -1 0"); at != std::string::npos; at = text.find(" 9.5 0 0 -1 0", at + 1))
    ++lids;
  EXPECT_EQ(lids, 1U) << text;
  EXPECT_TRUE(contains(text, "region          lid plane 0 9.5 0 0 -1 0 move"));
}

TEST_F(Convert, WallsOfVesselsIn2DAreThoseThatACodeHas) {
  const auto pack_in = [&](const std::string& vessel) {
    std::string scene = scene_text(2, "\"wall\"");
    const std::size_t begin = scene.find("dimension"), end = scene.find("[particles]");
    return make_pack_of(100, 2, scene.replace(begin, end - begin, "dimension = 2\n" + vessel));
  };
  const auto in_file = [&](const std::string& path, const std::string& format) {
    return contents(convert_pack(comm_, {.pack = path, .format = format, .force = true}).files.at(1));
  };
  const std::string circle = pack_in("shape = \"circle\"\ndiameter = 10.0\nheight = 0.6\n");
  EXPECT_TRUE(contains(in_file(circle, "lammps"), "region          mantle cylinder z 5 5 5 INF INF side in units box"));
  EXPECT_TRUE(contains(in_file(circle, "lammps"), "# circle: wall of radius 5 around x = y = 5; y from"));
  EXPECT_FALSE(contains(in_file(circle, "lammps"), "yplane"));
  EXPECT_TRUE(contains(in_file(circle, "liggghts"), "zcylinder 5 5 5"));
  EXPECT_FALSE(contains(in_file(circle, "liggghts"), "yplane"));
  EXPECT_TRUE(contains(in_file(circle, "yade"), "6: (Vector3(5, 5, 0), 5, 1, Vector3(1, 1, 0), Vector3(0, 0, 0)),"));
  EXPECT_TRUE(contains(refused({.pack = circle, .format = "pfc"}, ExitCode::bad_input),
                       "lammps or liggghts or yade, or csv, xyz, vtk or esys, which carry particles alone; or take a "
                       "rectangle out of it by --cut"));
  EXPECT_TRUE(
      contains(refused({.pack = circle, .format = "csv", .cut = "box:length=9,height=0.5"}, ExitCode::bad_input),
               "its corner (0.5, 0.05) m is outside the vessel"));
  const std::string hopper = pack_in("shape = \"trapezium\"\nbottom_width = 6.0\ntop_width = 12.0\nheight = 1.0\n");
  const std::string lammps = in_file(hopper, "lammps");
  EXPECT_TRUE(contains(lammps, "region          side1 plane 0 0 0 1 0 0 side in units box"));
  EXPECT_TRUE(contains(lammps, "region          side2 plane 12 0 0 -1 0 0 side in units box"));
  const std::string left = "region          side3 plane ";
  ASSERT_TRUE(contains(lammps, left));
  std::array<double, 6> plane{};  // a point of it, and the normal into the interior
  std::istringstream numbers(lammps.substr(lammps.find(left) + left.size()));
  for (double& number : plane) numbers >> number;
  EXPECT_NEAR(plane[0] / 3.0 + plane[1], 1.0, 1e-14);  // through (3, 0) and (0, 1)
  EXPECT_NEAR(plane[3], std::sqrt(0.1), 1e-15);
  EXPECT_NEAR(plane[4], 3.0 * std::sqrt(0.1), 1e-15);
  EXPECT_TRUE(contains(lammps, "yplane 0 NULL") && contains(lammps, "region side4\n"));
  EXPECT_FALSE(contains(lammps, "curvature"));
  const std::string yade = in_file(hopper, "yade");
  EXPECT_TRUE(contains(yade, "walls += [utils.facet(corners, material='walls') for corners in [\n"));
  EXPECT_TRUE(contains(yade, "utils.wall(0, axis=1") && contains(yade, "utils.wall(12, axis=0"));
  EXPECT_TRUE(
      contains(refused({.pack = hopper, .format = "liggghts"}, ExitCode::bad_input), "use lammps or yade, or csv"));
}

TEST_F(Convert, AMeshIsCarriedAsTriangles) {
  std::string text = scene_text(3, "");
  const mesh::Surface surface(testing::box({0, 0, 0}, {1.0, 1.0, 1.5}, 2), "box");
  const std::size_t from = text.find("dimension"), to = text.find("[particles]");
  text.replace(from, to - from,
               "shape = \"mesh\"\nheight = 0.6\nsurface = \"\"\"\n" + mesh::obj_text(surface.shell()) + "\"\"\"\n");
  const std::string path = make_pack_of(50, 3, text);
  const Converted yade = convert_pack(comm_, {.pack = path, .format = "yade", .force = true});
  const std::string script = contents(yade.files.at(1));
  EXPECT_TRUE(contains(script, "walls = []\nwalls += [utils.facet(corners, material='walls') for corners in [\n"));
  const std::string facets =
      script.substr(script.find("for corners in [\n"), script.find("\n]]") - script.find("for corners in [\n"));
  EXPECT_EQ(std::ranges::count(facets, '\n'), 6) << "a facet over each side of the box: " << facets;
  EXPECT_TRUE(contains(script, "# mesh: the interior of 1.5 m3 inside 48 triangles, from z = 0 to 1.5"));
  const mesh::Surface ell(testing::l_prism(1.0), "ell");
  EXPECT_EQ(exporters::yade::facets(ell).size(), ell.shell().triangles.size()) << "an edge sticks out";
  const Converted liggghts = convert_pack(comm_, {.pack = path, .format = "liggghts", .force = true});
  ASSERT_EQ(liggghts.files.size(), 3U);
  EXPECT_TRUE(contains(contents(liggghts.files[1]), "mesh/surface file ${surface} type 2"));
  const mesh::Surface again(mesh::read_triangles(contents(liggghts.files[2]), "a.stl"), "a");
  EXPECT_EQ(again.shell().triangles.size(), 48U);
  EXPECT_EQ(again.volume(), surface.volume());
  EXPECT_TRUE(contains(refused({.pack = path, .format = "lammps", .force = true}, ExitCode::bad_input),
                       "use liggghts or yade, or"));
  EXPECT_TRUE(contains(
      refused({.pack = path, .format = "csv", .cut = "cylinder:diameter=1,height=1.4,z=0.8,x=0.6", .force = true},
              ExitCode::bad_input),
      "along x"));
  const Converted cut = convert_pack(
      comm_, {.pack = path, .format = "csv", .cut = "cylinder:diameter=0.9,height=0.5,z=0.3", .force = true});
  EXPECT_GT(cut.particles, 0);
}

TEST_F(Convert, EveryCentreIsInsideTheBoxOfLammps) {
  for (const int dimension : {2, 3}) {
    const std::string path = make_pack(100, dimension, dimension == 3 ? "\"wall\", \"periodic\"" : "\"wall\"");
    const Converted done = convert_pack(comm_, {.pack = path, .format = "lammps", .force = true});
    const PackRows pack = read_pack(path);
    std::istringstream file(contents(done.files[0]));
    std::array<std::array<double, 2>, 3> box{};
    std::size_t axis = 0;
    for (std::string line; axis < 3 && std::getline(file, line);) {
      EXPECT_LE(line.size(), 254u);
      if (line.find("lo ") == std::string::npos || line.front() == 'L') continue;
      std::istringstream(line) >> box[axis][0] >> box[axis][1];
      ++axis;
    }
    ASSERT_EQ(axis, 3u);
    if (dimension == 3) {
      EXPECT_EQ(box[1], (std::array{0.0, 10.0}));
    } else {
      EXPECT_EQ(box[2], (std::array{-0.5, 0.5}));
    }
    for (const Vec3& x : pack.position) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_TRUE(box[c][0] < x[c] && x[c] < box[c][1]) << x[c];
    }
  }
}

/// The numbers behind `word` in a text.
std::vector<double> numbers_behind(const std::string& text, const std::string& word) {
  std::istringstream rest(text.substr(std::min(text.size(), text.find(word) + word.size())));
  std::vector<double> numbers;
  for (double x = 0.0; rest >> x;) numbers.push_back(x);
  return numbers;
}

// "hertz k e" is 4/3 E* and Tsuji's restitution: E* is E / (1 - nu^2), half of it for two that deform.
TEST_F(Convert, LammpsHasTheStiffnessOfPairsAndOfRigidWalls) {
  const std::string path = make_pack(20, 3, "\"wall\", \"periodic\"");
  const Converted done = convert_pack(comm_, {.pack = path, .format = "lammps"});
  const std::string text = contents(done.files.at(1));
  const double own_modulus = 1e8 / (1.0 - 0.25 * 0.25);
  const auto pairs = numbers_behind(text, "pair_coeff      * * hertz ");
  const auto wall = numbers_behind(text, "fix             wall_x all wall/gran granular hertz ");
  const auto floor = numbers_behind(text, "fix             floor all wall/gran granular hertz ");
  ASSERT_EQ(pairs.size(), 2u) << text;
  EXPECT_NEAR(pairs[0], 4.0 / 3.0 * 0.5 * own_modulus, 1e-9 * own_modulus);
  EXPECT_NEAR(pairs[1], tsuji_restitution(0.1), 1e-12);
  ASSERT_EQ(floor.size(), 2u) << text;
  EXPECT_NEAR(floor[0], 4.0 / 3.0 * own_modulus, 1e-9 * own_modulus);
  EXPECT_EQ(wall, floor);
  EXPECT_TRUE(contains(
      text, "timestep        " +
                fmt::format(
                    "{}", scene::build(input::parse(scene_text(3, "\"wall\", \"periodic\""), "scene", {})).time_step)));
}

TEST_F(Convert, AnEmptyPackIsAFileWithoutRows) {
  const std::string path = make_pack(0, 3, both_periodic);
  for (const FormatWords& format : convert_formats()) {
    EXPECT_EQ(convert_pack(comm_, {.pack = path, .format = format.name}).particles, 0) << format.name;
  }
}

TEST_F(Convert, WhatIsAskedWronglyIsRefusedAndNothingIsWritten) {
  const std::string path = make_pack(20, 3, "\"periodic\", \"wall\"");
  const ConvertRequest csv{.pack = path, .format = "csv"};
  const auto with = [&](const std::function<void(ConvertRequest&)>& change) {
    ConvertRequest request = csv;
    change(request);
    return refused(request, ExitCode::bad_input);
  };
  EXPECT_TRUE(contains(with([](auto& r) { r.format = "lamps"; }), "did you mean lammps?"));
  EXPECT_TRUE(contains(with([](auto& r) { r.copies = {1, 2}; }), "y ends in walls"));
  EXPECT_TRUE(contains(with([](auto& r) { r.copies = {0, 1}; }), "1 or more"));
  EXPECT_TRUE(contains(with([&](auto& r) { r.file = folder_.path(); }), "is a folder"));
  EXPECT_TRUE(contains(with([&](auto& r) { r.file = r.pack, r.force = true; }), "is the pack itself"));
  EXPECT_TRUE(contains(with([&](auto& r) { r.format = "lammps", r.file = folder_.file("a.in"); }), "second file"));
  for (const auto& [cut, words] : std::vector<std::pair<const char*, const char*>>{
           {"cilinder:diameter=1", "did you mean cylinder?"},
           {"cylinder:height=0.2", "its diameter is missing"},
           {"cylinder:diameter=1,radius=2", "a cylinder has no \"radius\"; there are diameter, height, x, y, z"},
           {"cylinder:diameter=1,diameter=1", "diameter is there twice"},
           {"cylinder:diameter=wide", "diameter is \"wide\"; give a length above 0"},
           {"cylinder:diameter=-1", "diameter is \"-1\"; give a length above 0"},
           {"cylinder:diameter=1,x=11.6", "from 11.1 to 12.1 m along x, and the container from 0 to 12 m"},
           {"sphere:diameter=0.7", "along z"}}) {
    EXPECT_TRUE(contains(with([&](auto& r) { r.cut = cut; }), words)) << cut;
  }
  EXPECT_TRUE(contains(with([](auto& r) { r.cut = "box:length=1", r.trim = Trim::cut; }), "give it without --trim"));
  EXPECT_TRUE(contains(with([](auto& r) { r.cut = "box:length=1", r.copies = {2, 1}; }), "without --replicate"));
  ConvertRequest flat = csv;
  EXPECT_EQ(files_in(folder_.path()), 1u);

  convert_pack(comm_, csv);
  EXPECT_TRUE(contains(refused(csv, ExitCode::bad_input), "use --force"));
  flat.pack = make_pack(20, 2, "\"periodic\"");
  flat.copies = {1, 2};
  EXPECT_TRUE(contains(refused(flat, ExitCode::bad_input), "no second lateral axis"));
  flat.copies = {1, 1};
  for (const std::string& cut : {std::string("cylinder:diameter=1"), csv.pack + ".stl"}) {
    write_file(comm_, csv.pack + ".stl", "solid\n");
    flat.cut = cut;
    EXPECT_TRUE(contains(refused(flat, ExitCode::bad_input), "cut out of packs in 3D"));
  }
}

TEST_F(Convert, WhatCannotBeReadOrWrittenLeavesNothingBehind) {
  const std::string path = make_pack(20, 3, both_periodic);
  EXPECT_TRUE(contains(refused({.pack = folder_.file("no.hdf"), .format = "csv"}, ExitCode::io_failure), "no.hdf"));
  EXPECT_TRUE(contains(refused({.pack = path, .format = "csv", .file = folder_.file("no/a.csv")}, ExitCode::io_failure),
                       "No such file"));
  if (comm_.rank() == 0) {
    std::ofstream(folder_.file("text.hdf")) << "not a pack";
    std::filesystem::create_directories(folder_.file("a.in.tmp"));  // the companion's temporary cannot be made
  }
  comm_.barrier();
  (void)refused({.pack = folder_.file("text.hdf"), .format = "csv"}, ExitCode::io_failure);
  (void)refused({.pack = path, .format = "lammps", .file = folder_.file("a.data")}, ExitCode::io_failure);
  EXPECT_EQ(files_in(folder_.path()), 3u);
}

// A dashpot of m* where the scene's is of 2/7 m*: the limit of an explicit step falls to (sqrt(z^2 + 1) - z) of both.
TEST(Law, AStrongerDashpotHasASmallerStep) {
  const auto step_of = [](std::vector<std::string> set) {
    set.emplace_back("contact.damping_ratio=0.3");
    Specimen specimen;
    specimen.scene = scene::build(input::parse(scene_text(3, both_periodic), "scene", {set}));
    return step_of_stronger_dashpot(specimen) / specimen.scene.time_step;
  };
  const std::string memory = "contact.tangential=\"mindlin\"";
  EXPECT_NEAR(step_of({memory}), (std::sqrt(1.315) - std::sqrt(0.315)) / (std::sqrt(1.09) - 0.3), 1e-12);
  EXPECT_EQ(step_of({}), 1.0);
}

TEST(Law, RestitutionIsThatOfTheDampingRatio) {
  EXPECT_NEAR(tsuji_restitution(0.1), 0.6103979305532861, 1e-12);
  EXPECT_NEAR(restitution(0.1), 0.7073512849095, 1e-12);
  EXPECT_EQ(restitution(0.0), 1.0);
  EXPECT_EQ(restitution(1.0), 0.0);
  for (const double xi : {0.0, 0.01, 0.3, 0.6, 1.0}) {
    const double e = tsuji_restitution(xi);
    const double alpha = 1.2728 - 4.2783 * e + 11.087 * std::pow(e, 2) - 22.348 * std::pow(e, 3) +
                         27.467 * std::pow(e, 4) - 18.022 * std::pow(e, 5) + 4.8218 * std::pow(e, 6);
    EXPECT_NEAR(alpha, std::sqrt(6.0) * xi, 1e-12) << xi;
  }
}

}  // namespace
}  // namespace packmpi::exporters
