#include "start/taken.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string_view>

namespace packmpi::start {
namespace {

// Reasons to stop of layers that were taken over.
constexpr const char* without_springs = "taken over";
constexpr const char* with_springs = "taken over, with what contacts remember";
// And of particles from a text file, what it had: "taken over: positions, radii; left: 2 other columns".
constexpr std::string_view from_text = "taken over: ";
constexpr std::string_view left_there = "; left: ";

}  // namespace

std::vector<GlobalId> first_ids_of(const comm::Comm& comm, const pack::PackRows& rows) {
  constexpr std::int32_t most = 1 << 20;
  const std::int32_t mine = rows.layer.empty() ? 0 : std::ranges::max(rows.layer);
  const auto layers = static_cast<std::size_t>(comm.max(std::int64_t{std::min(mine, most)})) + 1;
  std::vector<std::int64_t> last(layers, -1);  // ids, for the largest of all ranks
  std::vector<std::int64_t> first(layers,
                                  std::numeric_limits<std::int64_t>::min());  // negative: the least of all ranks
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const auto layer = static_cast<std::size_t>(std::min(rows.layer[k], most));
    first[layer] = std::max(first[layer], -rows.id[k]);
    last[layer] = std::max(last[layer], rows.id[k]);
  }
  comm.max(std::span(first));
  comm.max(std::span(last));
  std::vector<GlobalId> ids{0};
  for (std::size_t layer = 1; layer < layers; ++layer) {
    if (-first[layer] != last[layer - 1] + 1) return {0};
    ids.push_back(-first[layer]);
  }
  return ids;
}

std::string reason_of_pack(bool springs) { return springs ? with_springs : without_springs; }

std::string reason_of_text(const TextRows& read) {
  std::string how = std::string(from_text) + read.taken;
  if (!read.left.empty()) how += std::string(left_there) + read.left;
  return how;
}

std::string taken_words(const scene::Scene& scene, const pack::Progress& progress) {
  if (!scene.in.start) return "";
  std::int64_t layers = 0, particles = 0;
  std::string how;
  for (const report::LayerRow& row : progress.layers) {
    if (!is_taken_over(row)) continue;
    ++layers;
    particles = row.total;
    how = row.stop_reason;
  }
  std::string taken = "positions, radii, velocities", left;
  if (how.starts_with(from_text)) {
    const std::size_t end = how.find(left_there);
    taken = how.substr(from_text.size(), end == std::string::npos ? end : end - from_text.size());
    if (end != std::string::npos) left = how.substr(end + left_there.size()) + ", ";
  } else if (scene.features.rotation) {
    taken += ", spins";
  }
  if (how == with_springs) taken += ", what contacts remember";
  return fmt::format(
      "{} (digest {}): {} particles in {} layer{} taken over, with {}; not taken over: {}{}time and counters",
      scene.in.start->pack, scene.in.start->digest, particles, layers, layers == 1 ? "" : "s", taken, left,
      lacks_springs(scene, progress) ? "what contacts remember, " : "");
}

bool is_taken_over(const report::LayerRow& row) { return row.stop_reason.starts_with(without_springs); }

bool lacks_springs(const scene::Scene& scene, const pack::Progress& progress) {
  if (!scene.features.memory) return false;
  return std::ranges::any_of(progress.layers, [](const report::LayerRow& row) {
    return is_taken_over(row) && row.stop_reason != with_springs;
  });
}

}  // namespace packmpi::start
