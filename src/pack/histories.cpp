#include "pack/histories.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "disk/scatter.hpp"
#include "geometry/container.hpp"

namespace packmpi::pack {
namespace {

[[noreturn]] void refuse_contacts(const std::string& words) { throw Error(ExitCode::bad_checkpoint, words); }

auto ends(const HistoryRow& row) { return std::tie(row.holder, row.other); }

/// `into.values` from double `at` on.
void read_values(const disk::SealedFile& file, const scene::Storing& what, const disk::Range& range, std::size_t at,
                 std::vector<HistoryRow>& into) {
  const auto width = static_cast<std::size_t>(what.components);
  const auto values = file.numbers<double>("/contacts/" + std::string(what.name), range, width);
  if (!std::ranges::all_of(values, [](double x) { return std::isfinite(x); })) {
    refuse_contacts(fmt::format("its contacts have a {} that is not finite", what.name));
  }
  for (std::size_t k = 0; k < into.size(); ++k) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(k * width), width, into[k].values.begin() + at);
  }
}

}  // namespace

scene::Features stored_in(const disk::SealedFile& file, int dimension) {
  scene::Features features;
  features.dimension = dimension;
  features.memory = file.has_attribute("/", "contact_digest");
  features.rolling = features.memory && file.has("/contacts/rolling_displacement");
  return features;
}

std::vector<HistoryRow> read_histories(const disk::SealedFile& file, const comm::Comm& comm,
                                       const scene::Features& features, GlobalId particles) {
  const auto total = static_cast<std::int64_t>(file.extent<std::int64_t>("/contacts/holder").at(0));
  const disk::IdBlocks blocks{total, comm.size()};
  const std::int64_t begin = blocks.begin(comm.rank());
  const disk::Range range{total, begin, blocks.begin(comm.rank() + 1) - begin};
  std::vector<HistoryRow> rows(static_cast<std::size_t>(range.count));
  const auto holder = file.numbers<std::int64_t>("/contacts/holder", range, 1);
  const auto other = file.numbers<std::int64_t>("/contacts/other", range, 1);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].holder = holder[k], rows[k].other = other[k];
    const bool possible =
        holder[k] >= 0 && holder[k] < particles && other[k] < holder[k] && other[k] >= -GlobalId{geometry::most_walls};
    if (!possible)
      refuse_contacts(fmt::format("its contact {} has ends that cannot be", begin + static_cast<std::int64_t>(k)));
  }
  std::size_t at = 0;
  for (const scene::Storing& what : scene::storings(features)) {
    read_values(file, what, range, at, rows);
    at += static_cast<std::size_t>(what.components);
  }
  return rows;
}

void sort_by_ends(std::vector<HistoryRow>& rows) {
  std::ranges::sort(rows, [](const HistoryRow& a, const HistoryRow& b) { return ends(a) < ends(b); });
}

void check_once(const std::vector<HistoryRow>& sorted) {
  const auto twice =
      std::ranges::adjacent_find(sorted, [](const HistoryRow& a, const HistoryRow& b) { return ends(a) == ends(b); });
  if (twice == sorted.end()) return;
  refuse_contacts(fmt::format("the contact of particle {} with {} is there twice", twice->holder, twice->other));
}

std::uint64_t digest(const HistoryRow& row, const scene::Features& features) {
  const std::size_t stored = static_cast<std::size_t>(scene::stored_doubles(features)) * sizeof(double);
  std::array<char, 2 * sizeof(GlobalId) + sizeof(HistoryRow::values)> bytes{};
  std::memcpy(bytes.data(), &row.holder, sizeof row.holder);
  std::memcpy(bytes.data() + sizeof row.holder, &row.other, sizeof row.other);
  std::memcpy(bytes.data() + 2 * sizeof(GlobalId), row.values.data(), stored);
  return fnv_add(fnv_start, std::string_view(bytes.data(), 2 * sizeof(GlobalId) + stored));
}

}  // namespace packmpi::pack
