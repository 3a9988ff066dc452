/// The key table itself. To add a key: give it a member in input.hpp and a line here.
#include "input/keys.hpp"

#include <utility>

namespace packmpi::input {
namespace {

using Default = std::optional<std::string_view>;
using Place = std::function<Slot(Input&)>;
using Text = std::string_view;

constexpr Default mandatory = std::nullopt;
constexpr Range any{};
constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr Range above(double low) { return {low, unbounded, true, false}; }
constexpr Range at_least(double low) { return {low, unbounded, false, false}; }
constexpr Range between(double low, double high) { return {low, high, false, false}; }
constexpr Range inside(double low, double high) { return {low, high, true, true}; }

/// The member of Input a key fills: at(&Input::layers, &Layers::thickness).
// clang-format off
template <class... Member>
Place at(Member... member) {
  return [=](Input& in) -> Slot { return &(in .* ... .* member); };
}
// clang-format on

/// A member of a table that the reader makes when the file has it.
Place near(double NearField::*member) {
  return [=](Input& in) -> Slot { return &((*in.near_field).*member); };
}

Key real(Text path, Place place, const Quantity& quantity, Range range, Default standard, Text doc) {
  return {.path = path,
          .slot = std::move(place),
          .quantity = &quantity,
          .unit = quantity.si,
          .range = range,
          .standard = standard,
          .doc = doc};
}

Key reals(Text path, Place place, Count count, const Quantity& quantity, Range range, Default standard, Text doc) {
  Key key = real(path, std::move(place), quantity, range, standard, doc);
  key.count = count;
  return key;
}

Key whole(Text path, Place place, Range range, Default standard, Text doc) {
  return real(path, std::move(place), plain, range, standard, doc);
}

/// A word of a list, a flag or free text: whatever the member's type takes.
Key word(Text path, Place place, Default standard, Text doc) {
  return {.path = path, .slot = std::move(place), .standard = standard, .doc = doc};
}

Key word_of(Text path, Place place, std::vector<Text> choices, Default standard, Text doc) {
  Key key = word(path, std::move(place), standard, doc);
  key.choices = std::move(choices);
  return key;
}

/// A number whose unit is not one of ours, such as N m^beta.
Key in_unit(Text unit, Key key) {
  key.unit = unit;
  return key;
}

Key when(Condition condition, Key key) {
  key.when = condition;
  return key;
}

/// Recognised, and refused: any number but one.
Key only(double value, Key key) {
  key.only = value;
  return key;
}

bool is(const Input& in, SizeDistribution one) { return in.particles.radius.distribution == one; }

constexpr Condition boxed{"shape = \"box\"", [](const Input& in) { return in.container.shape == VesselShape::box; }};
constexpr Condition vessel{"shapes other than \"box\"", [](const Input& in) { return !boxed.holds(in); }};
constexpr Condition frustum{"shape = \"frustum\"",
                            [](const Input& in) { return in.container.shape == VesselShape::frustum; }};
constexpr Condition annulus{"shape = \"annulus\"",
                            [](const Input& in) { return in.container.shape == VesselShape::annulus; }};
constexpr Condition meshed{"shape = \"mesh\"", [](const Input& in) { return in.container.shape == VesselShape::mesh; }};
constexpr Condition cornered{"shape = \"prism\" or \"polygon\"", [](const Input& in) {
                               return in.container.shape == VesselShape::prism ||
                                      in.container.shape == VesselShape::polygon;
                             }};
constexpr Condition trapezium{"shape = \"trapezium\"",
                              [](const Input& in) { return in.container.shape == VesselShape::trapezium; }};
constexpr Condition round{"shape = \"cylinder\", \"sphere\", \"annulus\" or \"circle\"", [](const Input& in) {
                            return vessel.holds(in) && !frustum.holds(in) && !cornered.holds(in) && !meshed.holds(in) &&
                                   !trapezium.holds(in);
                          }};
constexpr Condition equal{"distribution = \"equal\"", [](const Input& in) { return is(in, SizeDistribution::equal); }};
constexpr Condition gaussian{"distribution = \"gaussian\"",
                             [](const Input& in) { return is(in, SizeDistribution::gaussian); }};
constexpr Condition lognormal{"distribution = \"lognormal\"",
                              [](const Input& in) { return is(in, SizeDistribution::lognormal); }};
constexpr Condition weibull{"distribution = \"weibull\"",
                            [](const Input& in) { return is(in, SizeDistribution::weibull); }};
constexpr Condition bidisperse{"distribution = \"bidisperse\"",
                               [](const Input& in) { return is(in, SizeDistribution::bidisperse); }};
constexpr Condition discrete{"distribution = \"discrete\"",
                             [](const Input& in) { return is(in, SizeDistribution::discrete); }};
constexpr Condition grading{"distribution = \"grading\"",
                            [](const Input& in) { return is(in, SizeDistribution::grading); }};
constexpr Condition bounded{"distribution = \"gaussian\", \"uniform\", \"lognormal\" or \"weibull\"",
                            [](const Input& in) {
                              return is(in, SizeDistribution::gaussian) || is(in, SizeDistribution::uniform) ||
                                     is(in, SizeDistribution::lognormal) || is(in, SizeDistribution::weibull);
                            }};
constexpr Condition listed{"distribution = \"list\"", [](const Input& in) { return is(in, SizeDistribution::list); }};
constexpr Condition several{"distribution = \"discrete\" or \"list\"",
                            [](const Input& in) { return discrete.holds(in) || listed.holds(in); }};
constexpr Condition graded{"distributions other than \"equal\" and \"list\"",
                           [](const Input& in) { return !equal.holds(in) && !listed.holds(in); }};
constexpr Condition layered{"layers.duration above 0", [](const Input& in) { return !insertion_alone(in); }};
constexpr Condition by_fraction{"layers.duration above 0 or scenes without particles.count",
                                [](const Input& in) { return layered.holds(in) || in.particles.count == 0; }};
constexpr Condition started{"[start] is present", [](const Input& in) { return in.start.has_value(); }};
constexpr Condition mindlin{"tangential = \"mindlin\"",
                            [](const Input& in) { return in.contact.tangential == Tangential::mindlin; }};
constexpr Condition sliding{"tangential = \"sliding\"", [](const Input& in) { return !mindlin.holds(in); }};
constexpr Condition viscous{"regularisation = \"viscous\"",
                            [](const Input& in) { return in.contact.regularisation == Regularisation::viscous; }};
constexpr Condition settled{"stop = \"settled\"",
                            [](const Input& in) { return in.dynamics.stop == StopRule::settled; }};
constexpr Condition near_field{"[near_field] is present", [](const Input& in) { return in.near_field.has_value(); }};

constexpr Condition mixed{"[[component]] is present", [](const Input& in) { return !in.components.empty(); }};
constexpr Condition targeted{"[target] is present", [](const Input& in) { return in.target.has_value(); }};
constexpr Condition confined{"[confinement] is present", [](const Input& in) { return in.confinement.has_value(); }};

// clang-format off
std::vector<Key> general_keys() {
  return {
    only(1, whole("schema_version", at(&Input::schema_version), at_least(1), "1",
          "Version of these keys; files written for another one are refused, not guessed at.")),
    whole("seed", at(&Input::seed), at_least(0), "1",
          "Names the pack among all packs of the scene: radii and positions are functions of it."),
    word_of("fidelity", at(&Input::fidelity), {"paper", "reference", "balanced", "draft"}, "paper",
          "Preset: what keys are that the scene does not give. \"paper\": a step of 1e-4 s, 1.0 s a layer, all particles move; "
          "\"reference\", \"balanced\", \"draft\": friction with memory, from dear to cheap; see doc/input.md, \"Presets\". Without the key, each key has its own default."),
  };
}

std::vector<Key> container_keys() {
  const auto container = &Input::container;
  return {
    whole("container.dimension", at(container, &Container::dimension), between(2, 3), "3",
          "2: discs in a rectangle (spheres whose centres stay in a plane); 3: spheres in a prism."),
    word("container.shape", at(container, &Container::shape), "box",
          "\"box\": a prism, in 2D a rectangle; \"cylinder\": a vertical one, whose axis is at x = y = diameter / 2; \"frustum\": a cone without its tip, "
          "wider above or below; \"sphere\": filled from above up to a height; \"annulus\": the room between two coaxial cylinders; \"prism\": upright over a polygon; \"mesh\": the room inside a closed surface of triangles; in 2D, \"circle\": filled from above up to a height, \"trapezium\": wider above or below, \"polygon\": a convex one (doc/vessels.md)."),
    when(boxed, reals("container.size", at(container, &Container::size), Count::axes, length, above(0), mandatory,
          "Lateral extents, then the height H_d to be filled: [L, H_d] in 2D, [L, B, H_d] in 3D. Of a cylinder [D, D, H_d] stands for diameter and height.")),
    when(round, real("container.diameter", at(container, &Container::diameter), length, above(0), mandatory, "Diameter inside.")),
    when(frustum, real("container.bottom_diameter", at(container, &Container::bottom_diameter), length, above(0), mandatory, "Diameter inside at the floor.")),
    when(frustum, real("container.top_diameter", at(container, &Container::top_diameter), length, above(0), mandatory,
          "Diameter inside at the height H_d. A frustum that widens goes on above H_d as a cylinder, one that narrows as the cone that it is.")),
    when(annulus, real("container.inner_diameter", at(container, &Container::inner_diameter), length, above(0), mandatory, "Diameter of the cylinder inside, seen from outside.")),
    when(trapezium, real("container.bottom_width", at(container, &Container::bottom_width), length, above(0), mandatory, "Width inside at the floor.")),
    when(trapezium, real("container.top_width", at(container, &Container::top_width), length, above(0), mandatory,
          "Width inside at the height H_d. A trapezium that widens goes on above H_d as wide as it is, one that narrows up to its tip.")),
    when(cornered, reals("container.polygon", at(container, &Container::polygon), Count::any, length, any, mandatory,
          "Corners [x, y], of a prism those of its section, one after the other, either way round; convex. The lower corner of the rectangle around it comes to x = y = 0. Packs have the prism as the mesh that it is.")),
    when(meshed, word("container.file", at(container, &Container::file), R"("")",
          "The surface, in the scene's folder or below it: STL in text or in binary (.stl), or OBJ (.obj). The lower corner of the box around it comes to x = y = z = 0.")),
    when(meshed, word("container.unit", at(container, &Container::unit), R"("m")", "What its lengths are in: \"m\", \"mm\" and the like.")),
    when(meshed, word("container.surface", at(container, &Container::surface), R"("")",
          "The surface itself, as the lines of an OBJ file in metres: in packs and checkpoints what was read from the file.")),
    when(vessel, real("container.height", at(container, &Container::height), length, above(0), mandatory, "The height H_d to be filled.")),
    when(boxed, reals("container.boundary", at(container, &Container::boundary), Count::lateral_axes, plain, any, "wall",
          "How each lateral axis ends. There is always a floor; the top is open.")),
  };
}

std::vector<Key> particle_keys() {
  const auto particles = &Input::particles;
  return {
    real("particles.density", at(particles, &Particles::density), density, above(0), mandatory, "Density of the material."),
    real("particles.youngs_modulus", at(particles, &Particles::youngs_modulus), pressure, above(0), mandatory,
         "Young's modulus E. Softer particles take larger steps and overlap more: 7e-4 r at 1e8 Pa, 3e-3 r at 1e7."),
    real("particles.poisson_ratio", at(particles, &Particles::poisson_ratio), plain, Range{-1, 0.5, true, false}, mandatory,
         "Poisson's ratio nu."),
    whole("particles.count", at(particles, &Particles::count), between(0, 0x1p40), "0",
          "Exactly so many particles: the last layer is cut to size, and the height that they come to is no target. 0: as many as the height takes."),
  };
}

std::vector<Key> radius_keys() {
  const auto at_radius = [](auto member) { return at(&Input::particles, &Particles::radius, member); };
  return {
    word("particles.radius.distribution", at_radius(&Radius::distribution), mandatory,
         "Which radii there are. They are drawn before placing, so that insertion does not distort them."),
    when(graded, word("particles.radius.weighting", at_radius(&Radius::weighting), mandatory,
         "What the distribution counts: \"number\", the share of particles; \"mass\", the share of mass, as sieves do; \"area\", that of discs in a section.")),
    when(equal, real("particles.radius.value", at_radius(&Radius::value), length, above(0), mandatory,
         "Radius of every particle.")),
    when(gaussian, real("particles.radius.mean", at_radius(&Radius::mean), length, above(0), mandatory,
         "Mean before truncation.")),
    when(gaussian, real("particles.radius.sd", at_radius(&Radius::sd), length, above(0), mandatory,
         "Standard deviation before truncation.")),
    when(lognormal, real("particles.radius.median", at_radius(&Radius::median), length, above(0), mandatory,
         "Median radius before truncation.")),
    when(lognormal, real("particles.radius.log_sd", at_radius(&Radius::log_sd), plain, Range{0, 5, true, false}, mandatory,
         "Standard deviation of ln(radius): the logarithm of the geometric standard deviation.")),
    when(weibull, real("particles.radius.scale", at_radius(&Radius::scale), length, above(0), mandatory,
         "Radius below which 63.2 % are (Rosin-Rammler: 1 - exp(-(r / scale)^shape) are finer), before truncation.")),
    when(weibull, real("particles.radius.shape", at_radius(&Radius::shape), plain, Range{0, 100, true, false}, mandatory,
         "Exponent of the same; a narrower distribution has a larger one.")),
    when(bounded, real("particles.radius.min", at_radius(&Radius::min), length, above(0), mandatory,
         "Smallest radius: the distribution is cut here.")),
    when(bounded, real("particles.radius.max", at_radius(&Radius::max), length, above(0), mandatory,
         "Largest radius: the distribution is cut here.")),
    when(bidisperse, real("particles.radius.small", at_radius(&Radius::small), length, above(0), mandatory,
         "Radius of the small particles.")),
    when(bidisperse, real("particles.radius.large", at_radius(&Radius::large), length, above(0), mandatory,
         "Radius of the large particles.")),
    when(bidisperse, real("particles.radius.large_share", at_radius(&Radius::large_share), ratio, inside(0, 1), mandatory,
         "Share of the large particles, by the weighting.")),
    when(several, reals("particles.radius.radii", at_radius(&Radius::radii), Count::any, length, above(0), "[]",
         "The radii there are: of classes, ascending; of a list, in any order, each used once.")),
    when(listed, word("particles.radius.list_file", at_radius(&Radius::list_file), R"("")",
         "The list as a CSV file in the scene's folder, one size a line; its first line is `diameter_mm` or `radius_mm`.")),
    when(listed, word("particles.radius.order", at_radius(&Radius::order), R"("random")",
         "Order in which the list is inserted, layer by layer: shuffled by the seed, or as in the file. Particle k of the pack is number k of this order.")),
    when(discrete, reals("particles.radius.shares", at_radius(&Radius::shares), Count::any, plain, above(0), mandatory,
         "The share of each radius, by the weighting; only their ratios count.")),
    when(grading, reals("particles.radius.diameter_curve", at_radius(&Radius::diameter_curve), Count::any, length, above(0), "[]",
         "The grading curve: DIAMETERS (sieve openings), each with the percentage that passes, from 0 to 100, in any order.")),
    when(grading, word("particles.radius.diameter_curve_file", at_radius(&Radius::diameter_curve_file), R"("")",
         "The same as a sieve table in the scene's folder, a CSV file: passing or retained, see doc/input.md, \"Sieve tables\".")),
    when(grading, word("particles.radius.interpolation", at_radius(&Radius::interpolation), R"("log")",
         "Between the points, the percentage is linear in the logarithm of the diameter, or in the diameter.")),
    when(grading, reals("particles.radius.keep_percent", at_radius(&Radius::keep_percent), Count::two, plain, between(0, 100), "[0.0, 100.0]",
         "Leave out what the curve has outside of these percentages: [5, 100] drops the finest 5 %.")),
  };
}

std::vector<Key> mixture_keys() {
  return {
    when(mixed, word_of("mixture.share_by", at(&Input::mixture, &Mixture::share_by), {"mass", "volume", "number"}, mandatory,
         "What the shares of components are of: \"mass\", solid \"volume\", or \"number\" of particles. See \"Components and strata\" below.")),
  };
}

std::vector<Key> layer_keys() {
  const auto layers = &Input::layers;
  return {
    real("layers.duration", at(layers, &Layers::duration), time, at_least(0), "1.0",
         "Simulated time of dynamics after each layer, at most. 0: insertion alone; the whole container is one layer, nothing moves, and no time step is asked for."),
    when(layered, real("layers.thickness", at(layers, &Layers::thickness), length, above(0), mandatory,
         "Height h_0 of the region above the bed that a layer is inserted into; the paper takes 0.2 H_d.")),
    when(by_fraction, real("layers.fraction", at(layers, &Layers::fraction), ratio, inside(0, 1), mandatory,
         "Solid fraction phi_0 of that region after insertion. Random insertion of equal radii ends at 0.547 in 2D, 0.384 in 3D; of graded ones, later.")),
    real("layers.gap", at(layers, &Layers::gap), length, at_least(0), "0.0",
         "Least distance between the surfaces of particles at insertion."),
    real("layers.youngs_modulus", at(layers, &Layers::youngs_modulus), pressure, above(0), "auto",
         "Modulus while layers settle; softer takes larger steps, and hardens in the final relaxation. \"auto\": that of the particles."),
    real("layers.time_step", at(layers, &Layers::time_step), time, above(0), "auto",
         "Time step while layers settle; \"auto\": dynamics.time_step, or for softer particles the limit of eq. (23)."),
    word("layers.height", at(layers, &Layers::height), "surface",
         "What must reach H_d: \"surface\", the mean over lateral columns of the highest top; \"highest\", the one highest top."),
    word("layers.region", at(layers, &Layers::region), "open",
         "Where a layer's region ends: \"open\", h_0 above the bed, whatever H_d is; \"container\", at H_d at most, and a scene is full "
         "when no particle fits below H_d."),
    reals("layers.velocity", at(layers, &Layers::velocity), Count::axes, velocity, any, "0.0",
         "Velocity of a particle when inserted; the last entry is vertical, upward."),
    reals("layers.spin", at(layers, &Layers::spin), Count::spin_axes, angular_velocity, any, "0.0",
         "Spin of a particle when inserted; in 2D one number, about the plane's normal."),
    whole("layers.attempts", at(layers, &Layers::attempts), between(1, 1e9), "10000",
         "Positions a particle may try before insertion gives up with an error."),
    whole("layers.maximum", at(layers, &Layers::maximum), between(0, 1 << 24), "0",
         "Stop after so many layers even below H_d; 0: no limit."),
  };
}

std::vector<Key> force_keys() {
  const auto contact = &Input::contact;
  return {
    real("jamming.gravity", at(&Input::jamming, &Jamming::gravity), acceleration, at_least(0), mandatory,
         "The jamming force of the paper: a downward acceleration, usually below 9.81 to keep impacts soft."),
    real("contact.damping_ratio", at(contact, &Contact::damping_ratio), plain, at_least(0), "0.1",
         "Fraction xi of critical damping of the normal contact; restitution depends on it alone. Beyond 1 the step must be smaller."),
    real("contact.restitution", at(contact, &Contact::restitution), plain, Range{0, 1, true, false}, "auto",
         "The other way to say damping: coefficient of restitution of two particles, at any speed. \"auto\": what damping_ratio gives. Not both."),
    real("contact.friction", at(contact, &Contact::friction), plain, at_least(0), "0.2",
         "Coefficient mu_d of sliding friction between particles."),
    real("contact.wall_friction", at(contact, &Contact::wall_friction), plain, at_least(0), "=contact.friction",
         "The same between particles and walls."),
    word("contact.tangential", at(contact, &Contact::tangential), "sliding",
         "Friction: \"mindlin\" remembers the tangential displacement of each contact and holds at rest; \"sliding\", the paper's, has no memory."),
    when(mindlin, real("contact.rolling_friction", at(contact, &Contact::rolling_friction), plain, at_least(0), "0.0",
         "Coefficient mu_r of the resistance to rolling: the torque is at most mu_r f_n r*. 0: none.")),
    when(mindlin, real("contact.twisting_friction", at(contact, &Contact::twisting_friction), plain, at_least(0), "0.0",
         "Coefficient mu_t of the resistance to spinning about the normal: the torque is at most mu_t f_n r*. 0: none.")),
    word("contact.friction_velocity", at(contact, &Contact::friction_velocity), "contact",
         "Slip is measured at the contact point, spin included, or between the centres, as printed in the paper's eq. (14)."),
    when(sliding, word("contact.regularisation", at(contact, &Contact::regularisation), "shared",
         "Friction at small slip: \"shared\" ends the slip of a contact within three steps, so that a particle's contacts together do not over-correct; "
         "\"stop\" within one (the paper's protocol; heats tall and rough beds); \"viscous\" within slip_time; \"none\" is the literal law.")),
    when(viscous, real("contact.slip_time", at(contact, &Contact::slip_time), time, above(0), mandatory,
         "Time in which friction may end a slip; at least two time steps.")),
    word("contact.tension_cutoff", at(contact, &Contact::tension_cutoff), "true",
         "Clamp the normal force at zero, so that parting particles do not pull."),
    word("contact.wall", at(contact, &Contact::wall), "rigid",
         "Stiffness of walls: rigid, or of the particles' material."),
    real("drag.coefficient", at(&Input::drag, &Drag::coefficient), drag_factor, at_least(0), "0.0",
         "c_fluid of the force -c (v - v_fluid) on each particle; the paper takes 0.005. 0: no drag."),
    reals("drag.fluid_velocity", at(&Input::drag, &Drag::fluid_velocity), Count::axes, velocity, any, "0.0",
         "Velocity v_fluid of the fluid, everywhere the same."),
  };
}

std::vector<Key> near_field_keys() {
  return {
    when(near_field, in_unit("N m^beta1", real("near_field.alpha1", near(&NearField::alpha1), plain, any, "0.0",
         "Attraction: pairs pull with alpha1 d^-beta1 at centre distance d."))),
    when(near_field, real("near_field.beta1", near(&NearField::beta1), plain, any, "0.0", "Exponent of the attraction.")),
    when(near_field, in_unit("N m^beta2", real("near_field.alpha2", near(&NearField::alpha2), plain, any, "0.0",
         "Repulsion: pairs push with alpha2 d^-beta2."))),
    when(near_field, real("near_field.beta2", near(&NearField::beta2), plain, any, "0.0", "Exponent of the repulsion.")),
    when(near_field, real("near_field.cutoff", near(&NearField::cutoff), length, above(0), mandatory,
         "Centre distance beyond which the near field is zero.")),
  };
}

std::vector<Key> dynamics_keys() {
  const auto dynamics = &Input::dynamics;
  return {
    word("dynamics.rotation", at(dynamics, &Dynamics::rotation), "true",
         "Particles spin. Off: there is no spin state at all, and slip is measured between centres."),
    real("dynamics.theta", at(dynamics, &Dynamics::theta), plain, between(0, 1), "0.0",
         "Time integration: 0 is the explicit Algorithm 2 of the paper; 0.5 (second order) to 1 (most damped) are implicit, and slow."),
    real("dynamics.time_step", at(dynamics, &Dynamics::time_step), time, above(0), "auto",
         "Time step, or \"auto\": from the contact duration, eq. (23)."),
    word("dynamics.stop", at(dynamics, &Dynamics::stop), "duration",
         "What ends the dynamics of a layer: its duration, or that it has settled, and its duration at the latest."),
    when(settled, real("dynamics.settled_energy", at(dynamics, &Dynamics::settled_energy), plain, above(0), "1e-3",
         "A layer has settled when the mean kinetic energy of moving particles is below this times m g d ...")),
    when(settled, real("dynamics.settled_drift", at(dynamics, &Dynamics::settled_drift), plain, above(0), "5e-3",
         "... and the speed of their mean height below this times sqrt(g d), d being the mean diameter ...")),
    when(settled, real("dynamics.settled_force", at(dynamics, &Dynamics::settled_force), plain, above(0), "1",
         "... and the mean force on a particle below this times the mean contact force (unbalanced force ratio) ...")),
    when(settled, real("dynamics.settled_hold", at(dynamics, &Dynamics::settled_hold), time, above(0), "0.05",
         "... for so long. All are looked at ten times in this time.")),
    whole("dynamics.window", at(dynamics, &Dynamics::window), between(0, 1 << 24), "0",
         "So many of the newest layers move; older ones stand still, as walls to them, until the final relaxation. 0: all move."),
    real("dynamics.relaxation", at(dynamics, &Dynamics::relaxation), time, at_least(0), "auto",
         "Duration of the final stage, in which all particles move; \"auto\": 0.9 s with a window, softer layers or a target, else none."),
  };
}

Place at_start(std::string Start::*member) {
  return [=](Input& in) -> Slot { return &((*in.start).*member); };
}

std::vector<Key> start_keys() {
  return {
    when(started, word("start.pack", at_start(&Start::pack), mandatory,
         "A pack (NAME.hdf), CSV or LAMMPS data file to go on from, its path from the scene's folder: its particles are there before the first layer. See doc/going_on.md.")),
    when(started, word("start.digest", at_start(&Start::digest), R"("")",
         "Digest of that file; another one is refused. A run fills it in.")),
    when(started, real("start.overlap_limit", [](Input& in) -> Slot { return &in.start->overlap; }, ratio, Range{0, 0.5, true, false}, "0.05",
         "Deepest overlap in it, over the smaller radius, that is taken: the final stage relaxes it. Deeper ones are refused.")),
  };
}

std::vector<Key> rest_keys() {
  const auto rest = &Input::rest;
  return {
    real("rest.unbalanced_force", at(rest, &Rest::unbalanced_force), plain, above(0), "0.05",
         "A pack is at rest if the mean net force on a particle is below this times the mean contact force (unbalanced force ratio) ..."),
    real("rest.kinetic_energy", at(rest, &Rest::kinetic_energy), plain, above(0), "1e-4",
         "... the mean kinetic energy of a particle below this times m g d, d being the mean diameter ..."),
    real("rest.support", at(rest, &Rest::support), plain, above(0), "0.02",
         "... and the vertical force of floor and walls differs from the weight by less than this times the weight. Any of these limits from 1e9 on is none."),
    real("rest.mean_overlap", at(rest, &Rest::mean_overlap), ratio, above(0), "0.01",
         "Limit of the mean overlap of touching particles, over the smaller radius."),
    real("rest.worst_overlap", at(rest, &Rest::worst_overlap), ratio, above(0), "0.05",
         "Limit of the deepest overlap, of two particles or with a wall, over the smaller radius."),
    real("rest.wait", at(rest, &Rest::wait), time, at_least(0), "auto",
         "The final stage goes on until the first three hold, but for so long at most; \"auto\": ten falls through H_d. 0: it does not."),
  };
}

std::vector<Key> target_keys() {
  const auto wish = [](auto member) -> Place { return [=](Input& in) -> Slot { return &((*in.target).*member); }; };
  return {
    when(targeted, real("target.solid_fraction", wish(&Target::solid_fraction), plain, inside(0, 1), "auto",
         "Solid fraction that the bulk of the pack is to have. Exactly one of this and the next three is given; friction while layers are filled in is found for it.")),
    when(targeted, real("target.porosity", wish(&Target::porosity), ratio, inside(0, 1), "auto", "The same as porosity n = 1 - phi.")),
    when(targeted, real("target.void_ratio", wish(&Target::void_ratio), plain, above(0), "auto", "The same as void ratio e = (1 - phi) / phi.")),
    when(targeted, real("target.relative_density", wish(&Target::relative_density), ratio, between(0, 1), "auto",
         "The same as (e_max - e) / (e_max - e_min), between the loosest and the densest state that `packmpi limits` finds of this scene.")),
    when(targeted, word("target.state", wish(&Target::state), "filled",
         "When the density holds: \"filled\", before [confinement], if there is one; \"confined\", under its stress, and samples are brought to it, too.")),
    when(targeted, real("target.tolerance", wish(&Target::tolerance), plain, above(0), "0.002", "What the bulk may differ by, in solid fraction, whichever was given.")),
    when(targeted, real("target.most_friction", wish(&Target::most_friction), plain, at_least(0), "=contact.friction",
         "The most friction between particles while layers are filled in; walls, rolling and twisting scale with it, the last two up to the scene's own. The final relaxation has the scene's own.")),
    when(targeted, real("target.most_rolling_friction", wish(&Target::most_rolling_friction), plain, at_least(0), "=contact.rolling_friction",
         "The most resistance to rolling while layers are filled in: more than the scene's own makes looser packs than most_friction alone.")),
  };
}

std::vector<Key> confinement_keys() {
  const auto at = [](auto member) -> Place { return [=](Input& in) -> Slot { return &((*in.confinement).*member); }; };
  return {
    when(confined, real("confinement.vertical", at(&Confinement::vertical), pressure, above(0), "auto",
         "Vertical stress, compression positive, that a rigid lid brings the finished pack to. Without lateral the sides stay where they are: the K0 state, in a vessel of any shape. Either this or isotropic is given.")),
    when(confined, real("confinement.lateral", at(&Confinement::lateral), pressure, above(0), "auto",
         "Lateral stress: walls of a box, or the periods of periodic axes, move until it is there. Only with vertical.")),
    when(confined, real("confinement.isotropic", at(&Confinement::isotropic), pressure, above(0), "auto", "The same stress on all sides of a box.")),
    when(confined, real("confinement.tolerance", at(&Confinement::tolerance), ratio, Range{0, 0.5, true, false}, "0.01",
         "What the stress on the boundary, and that of the contacts, may differ by, over the stress asked for.")),
    when(confined, real("confinement.wait", at(&Confinement::wait), time, above(0), "auto",
         "Simulated time at most until the stress is there and the pack at rest; \"auto\": what waves need to cross the pack 1000 times.")),
  };
}

std::vector<Key> program_keys() {
  return {
    word("parallel.decomposition", at(&Input::parallel, &Parallel::decomposition), "slab",
         "How lateral columns are shared among ranks: slices, pencils, or METIS parts. Changes no bit of the pack."),
    whole("ensemble.sets", at(&Input::ensemble, &Ensemble::sets), between(1, 1 << 12), "1", "Sets of packs, of one scene and different seeds."),
    whole("ensemble.packs", at(&Input::ensemble, &Ensemble::packs), between(1, 1 << 12), "1", "Packs of a set. Pack p of set s has the seed of the scene + 10000 (s - 1) + p - 1, and the bits of a run of its own with it."),
    word("checkpoint.every", at(&Input::checkpoint, &Checkpoint::every), R"("10min")",
         "Wall time between checkpoints (\"30 s\", \"10min\", \"2h\"), or time steps (\"5000 steps\"); \"off\": only when told to stop."),
    word("output.contacts", at(&Input::output, &Output::contacts), "false", "Write the contacts, with overlaps, forces and springs, too: with them a converted pack stays at rest."),
    word("output.analysis", at(&Input::output, &Output::analysis), "false", "Measure the pack inside when it is done, as `packmpi analyze` would: NAME.analysis.json."),
    real("output.log_every", at(&Input::output, &Output::log_every), time, at_least(0), "auto",
         "Simulated time between rows of NAME.steps.csv; 0: a row each step; \"auto\": a hundred steps."),
    word("petsc.options", at(&Input::petsc, &Petsc::options), R"("")", "Options for PETSc's solvers and reports, none that names a file: \"-log_view\", \"-implicit_snes_rtol 1e-9\"."),
  };
}
// clang-format on

}  // namespace

const std::vector<Key>& keys() {
  static const std::vector<Key> table = [] {
    std::vector<Key> all;
    for (const auto& part : {general_keys(), container_keys(), particle_keys(), radius_keys(), mixture_keys(),
                             layer_keys(), force_keys(), near_field_keys(), dynamics_keys(), start_keys(), rest_keys(),
                             target_keys(), confinement_keys(), program_keys()}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  }();
  return table;
}

std::pair<std::string_view, std::string_view> split_path(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return {"", path};
  return {path.substr(0, dot), path.substr(dot + 1)};
}

}  // namespace packmpi::input
