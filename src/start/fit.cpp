#include "start/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "base/error.hpp"
#include "input/read.hpp"
#include "pack/scene_change.hpp"
#include "report/json_seal.hpp"
#include "start/mixture.hpp"

namespace packmpi::start {
namespace {

std::uint64_t digest_of(const std::string& path) {
  return kind_of(path) == Kind::pack ? pack::seal_of(path) : digest_of_text(path);
}

// Without its lid a pack that was under stress is one like any other, but its sides stay where they went.
void check_sides(const input::Input& made, const confine::State& source, const scene::Scene& scene) {
  for (std::size_t a = 0; source.on && a + 1 < made.container.size.size(); ++a) {
    if (source.size[a] == made.container.size[a]) continue;
    refuse(scene,
           "start.pack: its sides were moved by [confinement], and a scene has them where container.size says; go "
           "on from a pack that was made without lateral and isotropic");
  }
}

void check_radii(const scene::Scene& scene, double smallest, double largest) {
  if (smallest >= scene.sizes.smallest() && largest <= scene.sizes.largest()) return;
  refuse(scene, fmt::format("start.pack: its radii are {:g} to {:g} m, those of the scene {:g} to {:g} m; give "
                            "particles.radius a range that has both",
                            smallest, largest, scene.sizes.smallest(), scene.sizes.largest()));
}

}  // namespace

void refuse(const scene::Scene& scene, const std::string& words) {
  throw Error(ExitCode::bad_input, fmt::format("{}: {}", scene.in.file, words));
}

std::string path_of(const input::Input& in) {
  return (std::filesystem::path(in.file).parent_path() / in.start->pack).string();
}

input::Input with_start(const comm::Comm& comm, input::Input in) {
  if (!in.start) return in;
  std::string digest;
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0) digest = report::hexadecimal(digest_of(path_of(in)));
  });
  digest = comm.broadcast(0, digest);
  if (!in.start->digest.empty() && in.start->digest != digest) {
    throw Error(ExitCode::bad_input, fmt::format("{}: start.digest: is {}, and {} has {}; it is another pack", in.file,
                                                 in.start->digest, in.start->pack, digest));
  }
  in.start->digest = digest;
  in.effective = input::effective_of(in);
  return in;
}

void check_fit(const scene::Scene& scene, const input::Input& made, const pack::PackSlice& slice) {
  check_sides(made, slice.confined, scene);
  const std::string moved = pack::container_change(made.container, scene.in.container);
  if (!moved.empty()) refuse(scene, "start.pack: is in " + moved);
  check_components(scene, made);
  for (const double radius : slice.rows.radius) check_radii(scene, radius, radius);
}

void fit_rows(const scene::Scene& scene, TextRows& found) {
  constexpr double same = 1e-6;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.container.lateral_axes()); ++axis) {
    if (!scene.container.periodic[axis]) continue;
    const double size = scene.container.size[axis];
    const std::array<double, 2> range = found.box ? (*found.box)[axis] : std::array{0.0, size};
    if (!(std::abs(range[1] - range[0] - size) < same * size)) {
      refuse(scene, fmt::format("start.pack: its box is {:g} m along {}, which is periodic, and the container {:g} m; "
                                "give container.size that of the box",
                                range[1] - range[0], "xy"[axis], size));
    }
    for (Vec3& position : found.rows.position) {
      double& at = position[axis];
      at -= range[0];
      if (at < 0.0 || at >= size) at -= size * std::floor(at / size);
      if (!(at < size)) at = 0.0;
    }
  }
  for (const double radius : found.rows.radius) check_radii(scene, radius, radius);
}

bool feels_anew(const input::Input& made, const scene::Scene& scene) {
  const std::string changes = pack::forbidden_changes(made.effective, scene.in.effective, pack::RunIs::finished);
  constexpr std::array tables{
      "contact.",          "jamming.",          "drag.",      "near_field.", "particles.density", "particles.youngs",
      "particles.poisson", "dynamics.rotation", "component[", "pair["};
  return std::ranges::any_of(tables, [&](const char* table) {
    return changes.starts_with(table) || changes.find(fmt::format("; {}", table)) != std::string::npos;
  });
}

}  // namespace packmpi::start
