#include "report/analysis.hpp"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "base/voids.hpp"
#include "report/composition_words.hpp"
#include "report/json_seal.hpp"
#include "report/size_words.hpp"

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

Json profile(const observe::Profile& p) { return {{"from", p.from}, {"width", p.width}, {"values", p.values}}; }

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

Json density(const observe::Analysis& a) {
  Json all = Json::object();
  for (std::size_t k = 0; k < a.density.size(); ++k) all[axis_names.at(k)] = profile(a.density[k]);
  return all;
}

Json order(const observe::Order& o, int dimension) {
  Json json{{"counted", o.counted}};
  if (dimension == 2) {
    json["psi6"] = o.psi6;
    json["psi6_together"] = o.psi6_together;
  } else {
    json["q4"] = o.q4;
    json["q6"] = o.q6;
    json["fcc"] = o.fcc;
    json["hcp"] = o.hcp;
    json["disordered"] = 1.0 - o.fcc - o.hcp;
  }
  return json;
}

// Share of the particles in the bulk whose cells others beyond the search might cut: the mean is of the rest.
double without_cell(const observe::LocalDensity& local) {
  return static_cast<double>(local.left_out) / static_cast<double>(local.counted + local.left_out);
}

Json rest(const observe::Analysis& a) {
  Json json{{"kinetic_energy", a.rest.kinetic_energy},
            {"mean_overlap", a.rest.mean_overlap},
            {"worst_overlap", a.rest.worst_overlap}};
  json["unbalanced_force"] = a.springs ? Json(a.rest.unbalanced_force) : Json(nullptr);
  json["support"] = a.springs ? Json(a.rest.support) : Json(nullptr);
  return json;
}

}  // namespace

std::string to_json(const observe::Analysis& a, int dimension, std::uint64_t pack_seal) {
  Json root;
  root["format"] = "packmpi-analysis";
  root["format_version"] = 2;
  root["particles"] = a.particles;
  root["mean_diameter"] = a.mean_diameter;
  root["sizes"] = to_json(a.sizes);
  if (!a.composition.parts.empty()) root["composition"] = composition_to_json(a.composition, {});
  root["density_profile"] = density(a);
  if (!a.radial.profile.values.empty()) {
    root["radial_profile"] = {{"from_wall", profile(a.radial.profile)},
                              {"core", {{"from_wall", a.radial.from_walls}, {"solid_fraction", a.radial.core}}}};
    if (!a.radial.from_inner.values.empty()) root["radial_profile"]["from_inner_wall"] = profile(a.radial.from_inner);
  }
  const auto of_cells = [&](double value) { return a.local.counted > 0 ? Json(value) : Json(); };  // null: of none
  root["local_density"] = {{"counted", a.local.counted},
                           {"left_out", a.local.left_out},
                           {"mean", of_cells(a.local.mean)},
                           {"porosity", of_cells(porosity(a.local.mean))},
                           {"void_ratio", of_cells(void_ratio(a.local.mean))},
                           {"sd", of_cells(a.local.sd)},
                           {"distribution", profile(a.local.distribution)}};
  root["contacts"] = {{"coordination", a.rest.network.coordination},
                      {"loose", a.rest.network.loose},
                      {"rattlers", a.rest.network.rattlers},
                      {"held_coordination", a.rest.network.held_coordination}};
  root["rest"] = rest(a);
  root["forces"] = {{"springs", a.springs},
                    {"contacts", a.forces.contacts},
                    {"mean_normal_force", a.forces.mean_normal_force},
                    {"fabric", a.forces.fabric},
                    {"stress", a.forces.stress},
                    {"distribution", profile(a.forces.distribution)},
                    {"floor_force", a.floor_force},
                    {"weight", a.weight}};
  root["pair_distribution"] = {{"centres", a.pairs.centres}, {"g", profile(a.pairs.g)}};
  root["order"] = order(a.order, dimension);
  root["segregation"] = {{"correlation", a.segregation.correlation},
                         {"mean_radius", profile(a.segregation.mean_radius)}};
  root["units"] = {{"mean_diameter", "m"},
                   {"density_profile", "m"},
                   {"from_wall", "m"},
                   {"mean_normal_force", "N"},
                   {"stress", dimension == 3 ? "Pa" : "N/m"},
                   {"floor_force", "N"},
                   {"weight", "N"},
                   {"mean_radius", "m"},
                   {"g", "mean diameters"},
                   {"d10", "m"},
                   {"d30", "m"},
                   {"d50", "m"},
                   {"d60", "m"},
                   {"d90", "m"}};
  root["seal"] = {{"pack", hexadecimal(pack_seal)}};
  return root.dump(2) + "\n";
}

std::string to_table(const observe::Analysis& a, int dimension) {
  fmt::memory_buffer out;
  const auto line = [&](std::string_view what, double value) {
    fmt::format_to(std::back_inserter(out), "  {:<58} {:>12.5g}\n", what, value);
  };
  fmt::format_to(std::back_inserter(out), "  {:<58} {:>12}\n", "particles", a.particles);
  for (const SizeLine& of : composition_lines(a.composition, {}))
    fmt::format_to(std::back_inserter(out), "  {:<44} {:>26}\n", of.quantity, of.achieved);
  line("coordination number", a.rest.network.coordination);
  line("share with too few contacts", a.rest.network.loose);
  line("rattlers, recursively", a.rest.network.rattlers);
  line("coordination number without rattlers", a.rest.network.held_coordination);
  if (a.springs) {
    line("unbalanced force ratio", a.rest.unbalanced_force);
    line("support by floor and walls / weight", a.rest.support);
  }
  line("kinetic energy / (m g d)", a.rest.kinetic_energy);
  line("mean overlap / r", a.rest.mean_overlap);
  line("worst overlap / r", a.rest.worst_overlap);
  if (a.radial.core > 0.0) {
    line("solid fraction three diameters from the wall", a.radial.core);
    line("porosity of it", porosity(a.radial.core));
  }
  if (a.local.counted > 0) {
    line("local solid fraction in the bulk, mean", a.local.mean);
    line("local solid fraction in the bulk, standard deviation", a.local.sd);
    line("porosity of that mean", porosity(a.local.mean));
    line("void ratio of that mean", void_ratio(a.local.mean));
    if (a.local.left_out > 0) line("share of particles without a cell of their own", without_cell(a.local));
  }
  line("force on the floor / weight", a.weight > 0.0 ? a.floor_force / a.weight : 0.0);
  line("mean normal force in the bulk [N]", a.forces.mean_normal_force);
  const auto v = static_cast<std::size_t>(dimension - 1);
  line(dimension == 3 ? "vertical stress in the bulk [Pa]" : "vertical stress in the bulk [N/m]",
       a.forces.stress[v][v]);
  line("lateral over vertical stress",
       a.forces.stress[v][v] > 0.0 ? a.forces.stress[0][0] / a.forces.stress[v][v] : 0.0);
  line("share of the vertical in the fabric", a.forces.fabric[v][v]);
  if (dimension == 2) {
    line("|psi_6| of a particle, mean", a.order.psi6);
    line("|psi_6| of all together", a.order.psi6_together);
  } else {
    line("q_4, mean", a.order.q4);
    line("q_6, mean", a.order.q6);
    line("fcc, share", a.order.fcc);
    line("hcp, share", a.order.hcp);
  }
  line("correlation of radius and height", a.segregation.correlation);
  fmt::format_to(std::back_inserter(out), "  {:<44} {:>12} {:>13}\n", "sizes", "target", "achieved");
  for (const SizeLine& size : size_lines(a.sizes)) {
    fmt::format_to(std::back_inserter(out), "  {:<44} {:>12} {:>13}\n", size.quantity, size.target, size.achieved);
  }
  if (!a.springs) {
    fmt::format_to(std::back_inserter(out),
                   "  The pack does not have what its contacts remember (output.contacts = true writes it): forces\n"
                   "  are without the springs of friction, and unbalanced force and support are not known.\n");
  }
  return fmt::to_string(out);
}

}  // namespace packmpi::report
