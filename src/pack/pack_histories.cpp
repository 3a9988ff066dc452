/// What the contacts of a pack remember: from /contacts and /wall_contacts to the rows of a checkpoint.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "disk/scatter.hpp"
#include "neighbor/contact_memory.hpp"
#include "pack/histories.hpp"
#include "pack/pack_file.hpp"

namespace packmpi::pack {
namespace {

[[noreturn]] void refuse_springs(const std::string& words) { throw Error(ExitCode::io_failure, words); }

/// Rows of one of the two groups, as they are in the file.
struct SpringRows {
  std::vector<Vec3> normal, tangential, rolling;
  std::vector<double> twisting;

  SpringRows(const disk::SealedFile& file, const std::string& group, const disk::Range& range, bool rolls)
      : normal(file.rows<double, Vec3>(group + "/normal", range)),
        tangential(file.rows<double, Vec3>(group + "/tangential_displacement", range)) {
    if (!rolls) return;
    rolling = file.rows<double, Vec3>(group + "/rolling_displacement", range);
    twisting = file.rows<double, double>(group + "/twisting_displacement", range);
  }

  /// Row k, in the order of scene::storings.
  void store(std::size_t k, const scene::Features& features, HistoryRow& into) const {
    auto* to = into.values.data();
    if (features.dimension == 3) {
      to = std::copy(tangential[k].begin(), tangential[k].end(), to);
      if (!features.rolling) return;
      to = std::copy(rolling[k].begin(), rolling[k].end(), to);
      *to = twisting[k];
      return;
    }
    *to++ = normal[k][0] * tangential[k][1] - normal[k][1] * tangential[k][0];  // along (-n_y, n_x)
    if (features.rolling) *to = rolling[k][2];
  }
};

/// This rank's share of so many rows.
disk::Range share_of(std::int64_t total, Rank rank, int ranks) {
  const disk::IdBlocks blocks{total, ranks};
  const std::int64_t begin = blocks.begin(rank);
  return {total, begin, blocks.begin(rank + 1) - begin};
}

void read_pairs(const disk::SealedFile& file, Rank rank, int ranks, Histories& into) {
  const auto total = static_cast<std::int64_t>(file.extent<std::int64_t>("/contacts/pair").at(0));
  const disk::Range range = share_of(total, rank, ranks);
  const auto pair = file.rows<std::int64_t, std::array<std::int64_t, 2>>("/contacts/pair", range);
  const SpringRows springs(file, "/contacts", range, into.features.rolling);
  for (std::size_t k = 0; k < pair.size(); ++k) {
    HistoryRow row{.holder = pair[k][1], .other = pair[k][0]};
    springs.store(k, into.features, row);
    into.rows.push_back(row);
  }
}

void read_walls(const disk::SealedFile& file, Rank rank, int ranks, Histories& into) {
  const auto total = static_cast<std::int64_t>(file.extent<std::int64_t>("/wall_contacts/particle").at(0));
  const disk::Range range = share_of(total, rank, ranks);
  const auto particle = file.rows<std::int64_t, std::int64_t>("/wall_contacts/particle", range);
  const auto wall = file.rows<std::int32_t, std::int32_t>("/wall_contacts/wall", range);
  const SpringRows springs(file, "/wall_contacts", range, into.features.rolling);
  for (std::size_t k = 0; k < particle.size(); ++k) {
    HistoryRow row{.holder = particle[k], .other = neighbor::wall_partner(neighbor::Wall{}) - wall[k]};
    springs.store(k, into.features, row);
    into.rows.push_back(row);
  }
}

void check_row(const HistoryRow& row, std::int64_t particles) {
  const bool possible = row.holder >= 0 && row.holder < particles && row.other < row.holder &&
                        row.other >= -GlobalId{geometry::most_walls};
  if (!possible) refuse_springs(fmt::format("its contact of {} and {} has ends that cannot be", row.other, row.holder));
  if (std::ranges::all_of(row.values, [](double x) { return std::isfinite(x); })) return;
  refuse_springs(fmt::format("the contact of {} and {} remembers what is no number", row.other, row.holder));
}

/// Runs `action`; what it throws is told of the pack at `path`.
template <class Action>
void explained_of_pack(const std::string& path, Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    throw Error(ExitCode::io_failure, fmt::format("cannot read {}: {}", path, error.what()));
  }
}

}  // namespace

namespace {

std::int64_t rows_in(const disk::SealedFile& file, const std::string& dataset) {
  return static_cast<std::int64_t>(file.extent<std::int64_t>(dataset).at(0));
}

/// What both groups have.
void read_touching(const disk::SealedFile& file, const std::string& group, std::int64_t total,
                   std::vector<TouchingRow>& into) {
  const disk::Range all{total, 0, total};
  const auto overlap = file.rows<double, double>(group + "/overlap", all);
  const auto normal = file.rows<double, Vec3>(group + "/normal", all);
  const auto force = file.rows<double, Vec3>(group + "/force", all);
  const auto tangential = file.rows<double, Vec3>(group + "/tangential_displacement", all);
  for (std::size_t k = 0; k < overlap.size(); ++k) {
    into.push_back({.overlap = overlap[k], .normal = normal[k], .force = force[k], .tangential = tangential[k]});
  }
}

void check_touching(const TouchingRow& row, std::int64_t particles) {
  const bool ends = row.wall >= 0 ? row.first >= 0 && row.first < particles
                                  : row.first >= 0 && row.first < row.second && row.second < particles;
  if (!ends) refuse_springs(fmt::format("its contact of {} and {} has ends that cannot be", row.first, row.second));
  const double sum =
      row.overlap + dot(row.normal, row.normal) + dot(row.force, row.force) + dot(row.tangential, row.tangential);
  if (!std::isfinite(sum))
    refuse_springs(fmt::format("the contact of {} and {} has no numbers", row.first, row.second));
}

}  // namespace

std::vector<TouchingRow> PackFile::touching() const {
  std::vector<TouchingRow> rows;
  if (!has_springs()) return rows;
  const std::int64_t pairs = rows_in(file_, "/contacts/pair");
  read_touching(file_, "/contacts", pairs, rows);
  const auto ends = file_.rows<std::int64_t, std::array<std::int64_t, 2>>("/contacts/pair", {pairs, 0, pairs});
  for (std::size_t k = 0; k < ends.size(); ++k) {
    rows[k].first = ends[k][0];
    rows[k].second = ends[k][1];
  }
  const std::int64_t walls = rows_in(file_, "/wall_contacts/particle");
  read_touching(file_, "/wall_contacts", walls, rows);
  const auto particle = file_.rows<std::int64_t, std::int64_t>("/wall_contacts/particle", {walls, 0, walls});
  const auto wall = file_.rows<std::int32_t, std::int32_t>("/wall_contacts/wall", {walls, 0, walls});
  for (std::size_t k = 0; k < wall.size(); ++k) {
    TouchingRow& row = rows[ends.size() + k];
    row.first = particle[k];
    row.second = -1;
    row.wall = wall[k];
    if (row.wall < 0) refuse_springs(fmt::format("particle {} touches wall {}", row.first, row.wall));
  }
  for (const TouchingRow& row : rows) check_touching(row, count_);
  return rows;
}

Histories PackFile::histories(Rank rank, int ranks) const {
  Histories all;
  all.features.dimension = dimension_;
  all.features.memory = has_springs();
  if (!all.any()) return all;
  all.features.rolling = file_.has("/contacts/rolling_displacement");
  read_pairs(file_, rank, ranks, all);
  read_walls(file_, rank, ranks, all);
  for (const HistoryRow& row : all.rows) check_row(row, count_);
  return all;
}

namespace {

// What touched the lid of a pack under stress does so no more where none comes.
void forget_lid(const scene::Scene& scene, Histories& all) {
  if (scene.in.confinement) return;
  const auto lid = neighbor::wall_partner(neighbor::Wall{}) - static_cast<int>(geometry::Surface::lid);
  std::erase_if(all.rows, [&](const HistoryRow& row) { return row.other == lid; });
}

}  // namespace

Histories histories_of(const comm::Comm& comm, const std::string& path, const scene::Scene& scene) {
  const disk::h5::Quiet quiet;
  Histories all;
  std::int64_t particles = 0;
  comm::agree_on(comm, [&] {
    explained_of_pack(path, [&] {
      const PackFile file(path);
      particles = file.count();
      all = file.histories(comm.rank(), comm.size());
      forget_lid(scene, all);
      if (all.any()) check_springs(all, scene);
    });
  });
  if (!all.any()) return all;
  all.rows = disk::scatter(comm, disk::IdBlocks{particles, comm.size()}, std::move(all.rows), &HistoryRow::holder);
  sort_by_ends(all.rows);
  comm::agree_on(comm, [&] { explained_of_pack(path, [&] { check_once(all.rows); }); });
  return all;
}

}  // namespace packmpi::pack
