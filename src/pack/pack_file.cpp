#include "pack/pack_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "pack/former_names.hpp"

namespace packmpi::pack {
namespace {

[[noreturn]] void refuse(const std::string& words) { throw Error(ExitCode::io_failure, words); }

bool finite(const Vec3& v) {
  return std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
}

/// What keeps row k from being a particle, "" if nothing does.
std::string flaw_of(const PackRows& rows, std::size_t k) {
  if (!finite(rows.position[k])) return "has a position that is no number";
  if (!finite(rows.velocity[k])) return "has a velocity that is no number";
  if (!rows.spin.empty() && !finite(rows.spin[k])) return "has a spin that is no number";
  if (!std::isfinite(rows.radius[k]) || !(rows.radius[k] > 0.0))
    return fmt::format("has the radius {}", rows.radius[k]);
  if (rows.layer[k] < 0) return fmt::format("is of layer {}", rows.layer[k]);
  if (rows.contacts[k] < 0) return fmt::format("has {} contacts", rows.contacts[k]);
  return "";
}

void check_particles(const PackRows& rows, std::int64_t first) {
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const std::int64_t row = first + static_cast<std::int64_t>(k);
    if (rows.id[k] != row) refuse(fmt::format("row {} has the id {}: the pack is damaged", row, rows.id[k]));
    if (const std::string flaw = flaw_of(rows, k); !flaw.empty()) refuse(fmt::format("particle {} {}", row, flaw));
  }
}

}  // namespace

PackFile::PackFile(const std::string& path) : file_(path) {
  version_ = file_.number<std::int64_t>("/", "format_version");
  if (version_ < oldest_pack_version || version_ > pack_version) {
    refuse(fmt::format("it has format version {}, and this packmpi reads {} to {}: use the packmpi that wrote it",
                       version_, oldest_pack_version, pack_version));
  }
  const auto dimension = file_.number<std::int64_t>("/summary", "dimension");
  if (dimension != 2 && dimension != 3) refuse(fmt::format("it is a pack in {} dimensions", dimension));
  dimension_ = static_cast<int>(dimension);
  const std::vector<hsize_t> sizes = file_.extent<std::int64_t>("/particles/id");
  if (sizes.size() != 1) refuse("/particles/id has another shape than it should");
  count_ = static_cast<std::int64_t>(sizes[0]);
  rotation_ = file_.has("/particles/spin");
}

PackRows PackFile::rows(std::int64_t begin, std::int64_t count) const {
  const disk::Range range{count_, begin, count};
  PackRows pack;
  pack.dimension = dimension_;
  pack.id = file_.rows<std::int64_t, GlobalId>("/particles/id", range);
  pack.position = file_.rows<double, Vec3>("/particles/position", range);
  pack.radius = file_.rows<double, double>("/particles/radius", range);
  pack.velocity = file_.rows<double, Vec3>("/particles/velocity", range);
  if (rotation_) pack.spin = file_.rows<double, Vec3>("/particles/spin", range);
  pack.layer = file_.rows<std::int32_t, std::int32_t>("/particles/layer", range);
  pack.contacts = file_.rows<std::int32_t, std::int32_t>("/particles/contacts", range);
  if (file_.has("/particles/component"))
    pack.component = file_.rows<std::int32_t, std::int32_t>("/particles/component", range);
  check_particles(pack, begin);
  return pack;
}

confine::State PackFile::confined() const {
  if (!file_.has_attribute("/summary", "lid")) return {};
  confine::State state{.on = true, .lid = number("/summary", "lid")};
  state.size = {number("/summary", "length_under_lid_x"), number("/summary", "length_under_lid_y")};
  const bool possible = state.lid > 0.0 && state.size[0] > 0.0 && (dimension_ == 2 || state.size[1] > 0.0);
  if (!possible) refuse("its lid or its sides are where none can be");
  return state;
}

std::string PackFile::scene() const {
  const std::string scene = text("/provenance", "effective_input");
  return version_ < pack_version ? scene_in_present_names(scene) : scene;
}

std::string PackFile::text(const char* object, const char* attribute) const { return file_.text(object, attribute); }

double PackFile::number(const char* object, const char* attribute) const {
  return file_.number<double>(object, attribute);
}

}  // namespace packmpi::pack
