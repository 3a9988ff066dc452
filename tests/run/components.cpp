// Packs of several components: shares and strata exact to a particle, on any number of ranks, in 3D and 2D.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "input/read.hpp"
#include "pack/pack.hpp"
#include "run/make_pack.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

const std::string materials =
    "[particles]\ndensity = 2000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "[layers]\nthickness = 0.1\nfraction = 0.2\nduration = 0.005\n[jamming]\ngravity = 2.0\n"
    "[rest]\nwait = 0\nunbalanced_force = 1e9\nkinetic_energy = 1e9\nsupport = 1e9\n"
    "[dynamics]\ntime_step = 1.0e-4\n[checkpoint]\nevery = \"off\"\n"
    "[[component]]\nname = \"a\"\nshare = 0.3\nradius = { distribution = \"uniform\", weighting = \"mass\", min = "
    "0.016, max "
    "= 0.02 }\n[[component]]\nname = \"b\"\nshare = 0.7\ndensity = 1000.0\nradius = { distribution = \"equal\", value "
    "= "
    "0.013 }\n";
const std::string box = "[container]\nsize = [0.3, 0.4, 0.3]\nboundary = [\"periodic\", \"periodic\"]\n" + materials;
const std::string plane = "[container]\ndimension = 2\nsize = [1.0, 0.6]\nboundary = [\"wall\"]\n" + materials;

struct Sums {
  std::array<double, 2> numbers{}, volumes{}, masses{}, largest{};  // largest: volume
};

class Components : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_components_" + std::to_string(::getppid()));

  // On all ranks, and on the first alone: equal to the bit.
  Sums made(const std::string& text) {
    const scene::Scene what = scene::build(input::parse(text, "box.toml", {}));
    const auto make = [&](const comm::Comm& comm, const char* name) {
      Options o;
      o.folder = (folder_ / name).string();
      o.verbosity = log::Verbosity::quiet;
      o.force = true;
      (void)make_pack(comm, what, o);
      comm.barrier();
      return pack::read_pack((folder_ / name / "box.hdf").string());
    };
    const pack::PackRows rows = make(comm_, "together");
    if (comm_.rank() == 0) {
      const pack::PackRows alone = make(comm::Comm(MPI_COMM_SELF), "alone");
      EXPECT_EQ(rows.position, alone.position);
      EXPECT_EQ(rows.component, alone.component);
    }
    comm_.barrier();
    Sums sums;
    for (std::size_t k = 0; k < rows.id.size(); ++k) {
      const auto c = static_cast<std::size_t>(rows.component[k]);
      const double volume = 4.0 / 3.0 * std::acos(-1.0) * std::pow(rows.radius[k], 3);
      sums.numbers[c] += 1.0, sums.volumes[c] += volume;
      sums.masses[c] += volume * what.in.components[c].particles.density;
      sums.largest[c] = std::max(sums.largest[c], volume);
    }
    return sums;
  }
};

double part(const std::array<double, 2>& of) { return of[0] / (of[0] + of[1]); }

// Each of the two is within half a particle of its part of what was asked for, and so is their ratio within one.
TEST_F(Components, SharesAreExactToAParticle) {
  for (const std::string& where : {box, plane}) {
    const Sums number = made(where + "[mixture]\nshare_by = \"number\"\n");
    EXPECT_NEAR(number.numbers[0], 0.3 * (number.numbers[0] + number.numbers[1]), 1.0);
    const Sums volume = made(where + "[mixture]\nshare_by = \"volume\"\n");
    EXPECT_NEAR(part(volume.volumes), 0.3, volume.largest[0] / (volume.volumes[0] + volume.volumes[1]));
    const Sums mass = made(where + "[mixture]\nshare_by = \"mass\"\n");
    EXPECT_NEAR(part(mass.masses), 0.3, mass.largest[0] * 2000.0 / (mass.masses[0] + mass.masses[1]));
    EXPECT_GT(mass.numbers[0], 10.0);
  }
}

// Of b 446.28 particles are asked for: one more than nearest would be seen.
TEST_F(Components, StrataByMassHaveTheirMasses) {
  const Sums sums =
      made(box +
           "[mixture]\nshare_by = \"mass\"\n[[stratum]]\nmass = 4.0\nshares = { a = 1.0 }\n[[stratum]]\nmass = "
           "3.0\n[[stratum]]\nmass = 2.007\nshares = { b = 1.0 }\n");
  EXPECT_NEAR(sums.masses[0], 4.0 + 0.3 * 3.0, 0.5 * 2000.0 * sums.largest[0] * (1.0 + 1e-9));
  EXPECT_NEAR(sums.masses[1], 0.7 * 3.0 + 2.007, 0.5 * 1000.0 * sums.largest[1] * (1.0 + 1e-9));
}

}  // namespace
}  // namespace packmpi::run
