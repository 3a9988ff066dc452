/// What is known of the particles that another code gets: sums, extents, what stands around them.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "handover/selection.hpp"
#include "handover/springs.hpp"

namespace packmpi::handover {

/// What writers know beside the particles. The same on all ranks.
struct Specimen {
  // Words as they are in the pack or the user's: exporters/quote.hpp before they are written.
  std::string pack;     ///< file name of the pack, without folder
  std::string file;     ///< file name of what is written, without folder
  std::string version;  ///< of the program that made the pack
  scene::Scene scene;   ///< the pack's own; of a specimen that is cut out, in the container around it
  bool rotation = true;
  std::string cut;            ///< what was cut out of the pack; "": nothing
  double cut_fraction = 0.0;  ///< its solid fraction, spheres cut by its sides
  double duration = 0.0;      ///< [s] simulated when the pack was made
  Trim trim = Trim::none;
  std::array<int, 2> copies{1, 1};
  std::int64_t count = 0;    ///< particles written
  double volume = 0.0;       ///< [m3] of them, as spheres; 9 digits
  double mass = 0.0;         ///< [kg] of them; 9 digits
  Vec3 size{};               ///< [m] lateral extents of all copies, then H_d; z of a 2D pack: 0
  double top = 0.0;          ///< [m] of the highest particle written
  double widest = 0.0;       ///< [m] largest radius written; 1 if nothing is
  Vec3 lowest{}, highest{};  ///< [m] of the centres
  Motions springs;           ///< what makes the springs of friction, by the pack's ids; for codes that take them so
  std::vector<pack::TouchingRow> touching;  ///< contacts with their forces; on rank 0, for codes that read forces

  [[nodiscard]] bool flat() const { return scene.container.dimension == 2; }
  /// A vessel that is no box: its walls go around the axis at x = y = radius, or are sides of a polygon.
  [[nodiscard]] bool round() const { return !scene.container.is_box(); }
  [[nodiscard]] bool has(geometry::Surface wall) const { return scene.container.has(wall); }
  [[nodiscard]] double radius() const { return scene.container.radius(); }  ///< [m] of it
  [[nodiscard]] std::size_t vertical() const { return static_cast<std::size_t>(scene.container.vertical()); }
  /// The name of a third file, without folder.
  [[nodiscard]] std::string beside(const char* ending) const;
  /// [s] with which the pack was last moved.
  [[nodiscard]] double step() const { return scene.container.lid ? scene.confining_step : scene.time_step; }
  /// Of axis x, y or z.
  [[nodiscard]] bool periodic(std::size_t axis) const { return axis < vertical() && scene.container.periodic[axis]; }
};

/// An interval [m].
struct Extent {
  double low, high;
};

/// A frustum's wall from below the floor to above the particles, for codes whose cones have ends: heights and radii
/// there [m].
struct ConeEnds {
  Extent height, radius;
};
[[nodiscard]] ConeEnds cone_ends(const Specimen& specimen);

/// The box the particles live in: walls or period, the floor, and above the higher of H_d and the top. z of 2D: 0, 0.
[[nodiscard]] std::array<Extent, 3> inner_box(const Specimen& specimen);
/// The same for codes that want every centre strictly inside: walls, floor and top moved outward by a radius or more,
/// periodic axes as they are. z of 2D: -0.5, 0.5.
[[nodiscard]] std::array<Extent, 3> padded_box(const Specimen& specimen);

/// Collective. Counts and measures the outgoing particles; this rank looks at its share. Its `file` is left open.
[[nodiscard]] Specimen survey(const comm::Comm& comm, const pack::PackFile& file, const Selection& selection,
                              const scene::Scene& scene);

}  // namespace packmpi::handover
