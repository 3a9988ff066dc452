/// A size distribution as a curve: shares of particles and of mass over the radius, whatever the scene gave it as.
#pragma once
#include <vector>

#include "input/input.hpp"

namespace packmpi::scene {

/// Radii in pieces, ascending. Within a piece the number density is a power of the radius, so every share, quantile and
/// draw has a formula of + - * / and roots: the same bits on any machine. Mass goes with the cube of the radius, of
/// discs too (they are spheres whose centres stay in a plane). Local, pure.
class SizeCurve {
 public:
  SizeCurve() = default;
  /// The distribution by its own weighting, truncated. Smooth ones (gaussian, lognormal, weibull) become 4096 pieces:
  /// no share is off by more than 1e-5. Precondition: input::check passed.
  explicit SizeCurve(const input::Radius& radius);

  [[nodiscard]] double smallest() const noexcept;  ///< [m]
  [[nodiscard]] double largest() const noexcept;   ///< [m]

  /// `weighting` is by number or by mass here: shares of area are those of mass of no body.
  /// Share of the particles (or the mass) with a radius of at most r [m].
  [[nodiscard]] double passing(input::Weighting weighting, double r) const;
  /// The smallest radius [m] that a share in (0, 1) of the particles (or the mass) does not exceed.
  [[nodiscard]] double quantile(input::Weighting weighting, double share) const;
  /// Mean over the particles of radius^power, power 0 .. 6 [m^power].
  [[nodiscard]] double moment(int power) const;
  /// A radius [m] by number from two numbers in [0, 1): the first chooses the piece, the second the place in it.
  [[nodiscard]] double draw(double first, double second) const;
  /// The radii where the curve bends or jumps, ascending [m].
  [[nodiscard]] std::vector<double> corners() const;

 private:
  struct Piece {
    double low, high;  // equal: a jump
    int power;         // number density ~ radius^-power
    double number;     // share of all particles
    double mass;       // share of all mass
  };
  void add(double low, double high, int power, double share);
  void finish(input::Weighting weighting);
  void add_smooth(const input::Radius& radius);
  void add_list(std::vector<double> radii);
  void add_classes(const std::vector<double>& radii, const std::vector<double>& shares);

  /// Several curves at once: pieces that overlap.
  struct Part;
  void add_parts(const input::Radius& radius);
  [[nodiscard]] double share_of_parts(input::Weighting weighting, double r) const;

  std::vector<Part> parts_;  // none: pieces
  std::vector<Piece> pieces_;
  std::vector<double> below_number_, below_mass_;  // cumulative shares up to the end of each piece; the last is 1
};

struct SizeCurve::Part {
  SizeCurve curve;
  double number, mass;  ///< share of all particles, and of all mass as if of one material
};

}  // namespace packmpi::scene
