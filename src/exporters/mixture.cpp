#include "exporters/mixture.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "exporters/lammps_family.hpp"
#include "exporters/law.hpp"

namespace packmpi::exporters {
namespace {

using scene::PairMaterial;

int components(const Specimen& s) { return static_cast<int>(s.scene.in.components.size()); }
const input::Component& component(const Specimen& s, int k) {
  return s.scene.in.components[static_cast<std::size_t>(k)];
}

/// "a b c d ..." of a table of (types x types), the last type being the walls'.
template <class Value>
std::string matrix(const Specimen& s, Value value) {
  const int count = components(s);
  std::string words;
  for (int a = 0; a <= count; ++a) {
    for (int b = 0; b <= count; ++b) {
      const int least = std::min(a, b), most = std::max(a, b);
      const PairMaterial of = most < count    ? scene::pair_material(s.scene.in, a, b)
                              : least < count ? scene::wall_material(s.scene.in, least)
                                              : scene::wall_material(s.scene.in, 0);  // walls never meet
      words += fmt::format(" {}", value(of));
    }
  }
  return words;
}

double wall_modulus(const Specimen& s, double rigid_factor) {
  double most = 0.0;
  for (const input::Component& of : s.scene.in.components) most = std::max(most, of.particles.youngs_modulus);
  return s.scene.in.contact.wall == input::WallStiffness::rigid ? rigid_factor * most : most;
}

}  // namespace

int kinds(const Specimen& s) { return std::max(1, components(s)); }

double density_of(const Specimen& s, const Outgoing& particle) {
  return components(s) == 0 ? s.scene.in.particles.density : component(s, particle.row.component).particles.density;
}

std::string kinds_words(const Specimen& s, std::string_view word, int first) {
  std::string words;
  for (int k = 0; k < components(s); ++k) {
    words += fmt::format("{}{} {}: {}", k == 0 ? "" : "; ", word, k + first, component(s, k).name);
  }
  return words;
}

namespace {

/// LAMMPS makes the damping from it, before its walls were written anew in 3 Nov 2022 once more at each run.
std::string restitution_word(double damping_ratio, int runs) {
  constexpr double most = 0.5, root_6 = 2.449489742783178;  // beyond, there is none that would do for two runs
  const double e = tsuji_restitution(damping_ratio);
  if (runs == 1 || damping_ratio > most) return fmt::format("{}", e);
  return fmt::format("$((version<20221103)*{}+(version>=20221103)*{}:%.17g)", tsuji_restitution(e / root_6), e);
}

}  // namespace

std::string lammps_law(const Specimen& s, const PairMaterial& of, double share, int runs) {
  constexpr double least = 1e-3, overlap = 5e-4;
  const bool history = remembers(s);
  const double xi = history ? of.damping_ratio : std::max(of.damping_ratio, least);
  std::string words =
      fmt::format("hertz {} {} damping tsuji ", 4.0 / 3.0 * of.normal_modulus, restitution_word(xi, runs));
  const std::string_view limit = s.scene.in.contact.tension_cutoff ? " limit_damping" : "";
  // Slip is damped by x normal dampings up to the limit; x makes that damping the same for every xi.
  if (!history)
    return fmt::format("{}tangential linear_nohistory {} {}{}", words, 1.0 / xi, of.friction.particles, limit);
  const double stiffness = 8.0 * of.shear_modulus;
  const bool turns = s.rotation && s.scene.in.contact.friction_velocity == input::FrictionVelocity::contact;
  const double damping = std::sqrt(4.0 * of.shear_modulus / of.normal_modulus * (turns ? 2.0 / 7.0 : 1.0));
  words += fmt::format("tangential mindlin_rescale/force {} {} {}", stiffness, damping, of.friction.particles);
  // Springs of rolling and twisting are constants there: that of sliding between the widest particles at this overlap,
  // of a radius. Pairs of several materials all have both, or LAMMPS cannot mix them.
  const double reduced = share * s.widest;
  const double mass = share * scene::densest(s.scene.in) * geometry::volume(3, s.widest);
  const double spring = stiffness * std::sqrt(reduced * overlap * s.widest);
  const double dashpot = 2.0 * of.damping_ratio * std::sqrt(spring * 2.0 / 7.0 * mass);
  const bool both = s.scene.features.mixture && s.scene.features.rolling;
  if (both || of.friction.rolling > 0.0) {
    words += fmt::format(" rolling sds {} {} {}", spring, dashpot, of.friction.rolling);
  }
  if (both || of.friction.twisting > 0.0) {
    words += fmt::format(" twisting sds {} {} {}", spring * reduced * reduced, dashpot * reduced * reduced,
                         of.friction.twisting * reduced);
  }
  return fmt::format("{}{}", words, limit);
}

std::string lammps_pairs(const Specimen& s, double rougher) {
  std::string text;
  for (int a = 0; a < components(s); ++a) {
    for (int b = a; b < components(s); ++b) {
      PairMaterial of = scene::pair_material(s.scene.in, a, b);
      of.friction.particles *= rougher;
      text += fmt::format("pair_coeff      {} {} {}\n", a + 1, b + 1, lammps_law(s, of, 0.5));
    }
  }
  return text;
}

std::string liggghts_material(const Specimen& s) {
  constexpr double rigid_factor = 1e5;
  const double least_restitution = 0.05;
  std::string moduli, ratios;
  for (const input::Component& of : s.scene.in.components) {
    moduli += fmt::format(" {}", of.particles.youngs_modulus);
    ratios += fmt::format(" {}", of.particles.poisson_ratio);
  }
  const int types = components(s) + 1;
  const std::string restitutions = matrix(s, [least_restitution](const PairMaterial& of) {
    return std::max(least_restitution, restitution(of.damping_ratio));
  });
  std::string text = fmt::format(
      "# {0}; type {1}: walls\n"
      "fix             m1 all property/global youngsModulus peratomtype{2} {3}\n"
      "fix             m2 all property/global poissonsRatio peratomtype{4} {5}\n"
      "fix             m3 all property/global coefficientRestitution peratomtypepair {1}{6}\n"
      "fix             m4 all property/global coefficientFriction peratomtypepair {1}{7}\n",
      kinds_words(s, "type", 1), types, moduli, wall_modulus(s, rigid_factor), ratios,
      component(s, 0).particles.poisson_ratio, restitutions,
      matrix(s, [](const PairMaterial& of) { return of.friction.particles; }));
  if (s.scene.features.rolling) {
    text += fmt::format("fix             m5 all property/global coefficientRollingFriction peratomtypepair {}{}\n",
                        types, matrix(s, [](const PairMaterial& of) { return of.friction.rolling; }));
  }
  return text;
}

std::string yade_materials(const Specimen& s) {
  constexpr const char* line =
      "O.materials.append(FrictMat(young={}, poisson={}, density={}, frictionAngle=math.atan({}), label='{}'))\n";
  std::string text;
  for (const input::Component& of : s.scene.in.components) {
    text += fmt::format(fmt::runtime(line), of.particles.youngs_modulus, of.particles.poisson_ratio,
                        of.particles.density, of.friction, "of_" + of.name);
  }
  const input::Component& first = component(s, 0);
  return text + fmt::format(fmt::runtime(line), wall_modulus(s, 1e5), first.particles.poisson_ratio,
                            first.particles.density, first.wall_friction, "walls");
}

std::string yade_physics(const Specimen& s) {
  const auto matches = [&](auto value) {
    std::string words;
    for (int a = 0; a < components(s); ++a) {
      for (int b = a; b < components(s); ++b) {
        words += fmt::format("({}, {}, {}), ", a, b, value(scene::pair_material(s.scene.in, a, b)));
      }
      words += fmt::format("({}, {}, {}), ", a, components(s), value(scene::wall_material(s.scene.in, a)));
    }
    return fmt::format("MatchMaker(matches=({}))", words.substr(0, words.size() - 2));
  };
  return fmt::format("frictAngle={}, betan={}, betas={}",
                     matches([](const PairMaterial& of) { return std::atan(of.friction.particles); }),
                     matches([](const PairMaterial& of) { return of.damping_ratio; }),
                     matches([](const PairMaterial& of) { return of.damping_ratio; }));
}

std::string yade_reader(const Specimen& s) {
  std::string labels;
  for (const input::Component& of : s.scene.in.components) labels += fmt::format("'of_{}', ", of.name);
  return fmt::format(
      "labels = [{}]   # the fifth column: the material's number\nids = []\n"
      "for line in open(data):\n"
      "    words = line.split()\n"
      "    if words[0] == '##PERIODIC::':\n"
      "        O.periodic = True\n        O.cell.setBox(*[float(w) for w in words[1:4]])\n        continue\n"
      "    x, y, z, r = (float(w) for w in words[:4])\n"
      "    ids.append(O.bodies.append(utils.sphere((x, y, z), r, material=labels[int(words[4])])))\n",
      labels.substr(0, labels.size() - 2));
}

}  // namespace packmpi::exporters
