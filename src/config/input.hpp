/// A scene file as plain structs in SI units: what the user asked for, checked key by key, nothing derived.
/// Names and nesting follow the TOML (doc/input.md is generated from the same table that reads it: input/keys.cpp).
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/types.hpp"
#include "geometry/polygon.hpp"
#include "mesh/surface.hpp"

namespace packmpi::input {

enum class VesselShape { box, cylinder, frustum, sphere, annulus, prism, mesh, circle, trapezium, polygon };
enum class Boundary { wall, periodic };
enum class SizeDistribution {
  equal,
  gaussian,
  uniform,
  lognormal,
  weibull,
  bidisperse,
  discrete,
  grading,
  list,
  mixture
};  // the last: of components
enum class Weighting { number, mass, area };
enum class ListOrder { random, file };
enum class Interpolation { log, linear };
enum class HeightRule { surface, highest };
enum class RegionRule { open, container };
enum class FrictionVelocity { contact, centre };
enum class Tangential { sliding, mindlin };
enum class Regularisation { stop, shared, viscous, none };
enum class WallStiffness { rigid, material };
enum class StopRule { duration, settled };
enum class Decomposition { slab, pencil, metis };

/// Points in two numbers. Of a grading [diameter in m, percent passing], ascending once they have been read.
using Curve = std::vector<std::array<double, 2>>;

struct Container {
  int dimension = 3;  ///< 2 or 3
  VesselShape shape = VesselShape::box;
  double diameter = 0.0, height = 0.0;  ///< [m] inside, and the desired height H_d: of vessels that are no box
  double bottom_diameter = 0.0, top_diameter = 0.0;  ///< [m] of a frustum, at the floor and at H_d
  double inner_diameter = 0.0;                       ///< [m] of an annulus
  double bottom_width = 0.0, top_width = 0.0;        ///< [m] of a trapezium, at the floor and at H_d
  Curve polygon;           ///< [m] corners of a polygon, or of the section of a prism, which is a mesh once it is read
  std::string file, unit;  ///< of a mesh: STL or OBJ beside the scene, and its unit; "" and "m" once it has been read
  std::string surface;     ///< of a mesh: the lines of an OBJ file [m]; what the file has, once it has been read
  std::shared_ptr<const mesh::Surface> mesh;       ///< made of them, once they have been read
  std::shared_ptr<const geometry::Polygon> sides;  ///< of a trapezium or polygon, once it has been read
  std::vector<double> size;        ///< [m] lateral extents, then the desired height H_d; `dimension` numbers. Of other
                                   ///< vessels than a box: what is around them, once the scene has been read
  std::vector<Boundary> boundary;  ///< one per lateral axis; of other vessels than a box: walls
};

enum class Body { sphere, cylinder, box, mesh };
enum class Axis { x, y, z };

/// What stands or hangs in the container. Once the scene has been read the container is a mesh that has them as holes.
struct Obstacle {
  Body shape = Body::sphere;
  double diameter = 0.0, length = 0.0;  ///< [m] of a sphere or cylinder; along the axis
  Axis axis = Axis::z;                  ///< of a cylinder
  Vec3 size{};                          ///< [m] of a box
  std::string file, unit;               ///< of a mesh: STL or OBJ beside the scene, and its unit
  std::optional<Vec3> position;         ///< [m] of its middle; none: a mesh is where its file has it
  std::string place;                    ///< in the scene file, for messages
};

struct Radius {
  SizeDistribution distribution = SizeDistribution::equal;
  Weighting weighting = Weighting::number;           ///< what the distribution counts: particles, their mass or area
  double value = 0.0;                                ///< [m] equal
  double mean = 0.0, sd = 0.0;                       ///< [m] gaussian
  double median = 0.0, log_sd = 0.0;                 ///< [m], [-] lognormal: sd of ln(radius)
  double scale = 0.0, shape = 0.0;                   ///< [m], [-] weibull
  double min = 0.0, max = 0.0;                       ///< [m] uniform; truncation of gaussian, lognormal, weibull
  double small = 0.0, large = 0.0;                   ///< [m] bidisperse
  double large_share = 0.0;                          ///< [-] bidisperse
  std::vector<double> radii, shares;                 ///< [m], any unit: discrete; radii alone: list
  Curve diameter_curve;                              ///< grading; of diameters, as sieves have them
  std::string diameter_curve_file;                   ///< CSV beside the scene; "" once it has been read
  std::string list_file;                             ///< CSV beside the scene; "" once it has been read
  ListOrder order = ListOrder::random;               ///< list: in which its radii are inserted
  Interpolation interpolation = Interpolation::log;  ///< grading: linear in log(diameter) or in the diameter
  std::array<double, 2> keep_percent{0.0, 100.0};    ///< grading: what lies outside is left out
  std::vector<Radius> parts;                         ///< mixture: of the components; shares by number or volume
  bool diameters = false;                            ///< while reading: the scene gives diameters
};

struct Particles {
  double density = 0.0;         ///< [kg/m3]
  double youngs_modulus = 0.0;  ///< [Pa]
  double poisson_ratio = 0.0;   ///< [-]
  std::int64_t count = 0;       ///< exactly so many; 0: as many as it takes
  Radius radius;
};

inline constexpr int most_components = 8;

/// A material of its own among others, with its own sizes.
struct Component {
  std::string name;
  double share = 0.0;   ///< of all components', see Mixture; only ratios count
  Particles particles;  ///< its count is of no meaning
  double friction = 0.0, wall_friction = 0.0, damping_ratio = 0.0;  ///< [-]
  double rolling_friction = 0.0, twisting_friction = 0.0;           ///< [-]
};

/// What a contact of two components has that does not follow from each of them.
struct ComponentPair {
  int first = 0, second = 0;                                            ///< numbers of components
  std::optional<double> friction = {}, damping_ratio = {};              ///< [-]
  std::optional<double> rolling_friction = {}, twisting_friction = {};  ///< [-]
};

struct Mixture {
  std::string share_by = "mass";  ///< what shares of components are of: mass, volume or number
};

/// A part of the bed from below, with shares of its own. By height or by mass, all of a scene alike.
struct Stratum {
  std::string name;
  std::optional<double> top;   ///< [m] height in the pack where it ends; the last one's may be H_d
  std::optional<double> mass;  ///< [kg] inserted
  std::vector<double> shares;  ///< of each component, in their order; only ratios count
};

struct Layers {
  double thickness = 0.0;                ///< [m] h_0
  double fraction = 0.0;                 ///< [-] phi_0
  double duration = 0.0;                 ///< [s] of dynamics a layer, at most; 0: insertion alone
  std::optional<double> youngs_modulus;  ///< [Pa] while layers settle; none: "auto"
  std::optional<double> time_step;       ///< [s] while layers settle; none: "auto"
  HeightRule height = HeightRule::surface;
  RegionRule region = RegionRule::open;
  Vec3 velocity{};            ///< [m/s] at insertion
  Vec3 spin{};                ///< [rad/s] at insertion; 2D: only z
  double gap = 0.0;           ///< [m] least distance of surfaces at insertion
  std::int64_t attempts = 0;  ///< trials a particle may have before RSA gives up
  std::int64_t maximum = 0;   ///< layers at most; 0: no limit but the program's own bound
};

struct Jamming {
  double gravity = 0.0;  ///< [m/s2] downward
};

struct Contact {
  double damping_ratio = 0.0;         ///< [-] xi
  std::optional<double> restitution;  ///< [-] the other way to say it: damping_ratio has its value; none: "auto"
  double friction = 0.0;              ///< [-] mu_d
  double wall_friction = 0.0;         ///< [-]
  Tangential tangential = Tangential::sliding;
  double rolling_friction = 0.0;   ///< [-] mu_r
  double twisting_friction = 0.0;  ///< [-] mu_t
  FrictionVelocity friction_velocity = FrictionVelocity::contact;
  Regularisation regularisation = Regularisation::stop;
  double slip_time = 0.0;  ///< [s] viscous only
  bool tension_cutoff = true;
  WallStiffness wall = WallStiffness::rigid;
};

struct Drag {
  double coefficient = 0.0;  ///< [N s/m]
  Vec3 fluid_velocity{};     ///< [m/s]
};

struct NearField {  ///< f_ij = (alpha1 d^-beta1 - alpha2 d^-beta2) n_ij for d < cutoff
  double alpha1 = 0.0, beta1 = 0.0, alpha2 = 0.0, beta2 = 0.0;
  double cutoff = 0.0;  ///< [m] between centres
};

struct Dynamics {
  bool rotation = true;
  double theta = 0.0;               ///< 0: explicit; 0.5 to 1: implicit
  std::optional<double> time_step;  ///< [s]; none: "auto" (eq. 23)
  StopRule stop = StopRule::duration;
  double settled_energy = 0.0, settled_drift = 0.0, settled_force = 0.0;  ///< [-] limits of "settled"
  double settled_hold = 0.0;                                              ///< [s] for which all must hold
  int window = 0;                                                         ///< newest layers that move; 0: all
  std::optional<double> relaxation;                                       ///< [s] of the final stage; none: "auto"
};

/// At which a pack is at rest; beyond one of them the run has missed a target. See observe::Rest. Infinite: not asked.
struct Rest {
  double unbalanced_force = std::numeric_limits<double>::infinity();  ///< [-]
  double kinetic_energy = std::numeric_limits<double>::infinity();    ///< [-] of m g d
  double support = std::numeric_limits<double>::infinity();           ///< [-] its distance from 1
  double mean_overlap = std::numeric_limits<double>::infinity();      ///< [-] of a radius
  double worst_overlap = std::numeric_limits<double>::infinity();     ///< [-] of a radius
  std::optional<double> wait = 0.0;  ///< [s] that the final stage goes on at most until it is; none: "auto"
};

struct Start {           ///< from a pack that is there
  std::string pack;      ///< path from the scene's folder
  std::string digest;    ///< of the pack, hexadecimal; "" until it has been looked at
  double overlap = 0.0;  ///< [-] of a radius: deeper overlaps of its particles are refused
};

/// [-] While layers are filled in, friction between particles is no less: below, a bed is no denser, and takes longer
/// to come to rest.
inline constexpr double least_filling_friction = 1e-3;

/// When a target's density holds: before [confinement], or under its stress.
enum class TargetState { filled, confined };

/// The density that the bulk of the pack is to have; exactly one of the first four is given.
struct Target {
  std::optional<double> solid_fraction, porosity, void_ratio;  ///< [-]
  std::optional<double> relative_density;  ///< [-] (e_max - e) / (e_max - e_min), the limits being this scene's own
  TargetState state = TargetState::filled;
  double tolerance = 0.0;              ///< [-] in solid fraction
  double most_friction = 0.0;          ///< [-] between particles while layers are filled in
  double most_rolling_friction = 0.0;  ///< [-] likewise
};

/// The stress [Pa] that the finished pack is brought to, compression positive. `isotropic`, or `vertical` with or
/// without `lateral`; without, lateral strain is zero.
struct Confinement {
  std::optional<double> vertical, lateral, isotropic;
  double tolerance = 0.0;      ///< [-] of the stress asked for
  std::optional<double> wait;  ///< [s] at most until it is there; none: "auto"

  [[nodiscard]] double on_lid() const { return isotropic ? *isotropic : vertical.value_or(0.0); }
  [[nodiscard]] std::optional<double> on_sides() const { return isotropic ? isotropic : lateral; }
};

struct Parallel {
  Decomposition decomposition = Decomposition::slab;
};

struct Ensemble {
  int sets = 1, packs = 1;
};

struct Checkpoint {
  std::string every = "10min";  ///< see rhythm_of()
};

struct Output {
  bool contacts = false;            ///< write /contacts
  bool analysis = false;            ///< write NAME.analysis.json
  std::optional<double> log_every;  ///< [s] simulated, from row to row of NAME.steps.csv; 0: each step; none: "auto"
};

struct Petsc {
  std::string options;  ///< passed to PETSc as they are
};

/// One scene. `name` is the stem of the scene file: outputs are called NAME.hdf and so on.
struct Input {
  std::string name;
  std::string file;  ///< as the user gave it, for messages
  int schema_version = 1;
  std::uint64_t seed = 1;
  std::string fidelity = "paper";
  Container container;
  std::vector<Obstacle> obstacles;  ///< none once the scene has been read
  Particles particles;  ///< of several components: the stiffest modulus, the least density, the sizes of all
  Mixture mixture;
  std::vector<Component> components;  ///< none, or several
  std::vector<ComponentPair> pairs;
  std::vector<Stratum> strata;  ///< from below
  Layers layers;
  Jamming jamming;
  Contact contact;
  Drag drag;
  std::optional<NearField> near_field;  ///< none: off
  Dynamics dynamics;
  std::optional<Start> start;  ///< none: from nothing
  Rest rest;
  std::optional<Target> target;            ///< none: the density that comes
  std::optional<Confinement> confinement;  ///< none: the pack has a free surface
  Parallel parallel;
  Ensemble ensemble;
  Checkpoint checkpoint;
  Output output;
  Petsc petsc;
  std::vector<std::string> remarks;  ///< how files beside the scene were read, a line each
  std::string effective;             ///< the scene with every default filled in, as TOML; the provenance
};

/// Particles are placed, and nothing moves: the layer is the whole container.
[[nodiscard]] inline bool insertion_alone(const Input& in) { return in.layers.duration == 0.0; }

}  // namespace packmpi::input
