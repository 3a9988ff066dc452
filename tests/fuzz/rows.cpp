/// The readers of particles that other programs have written down, CSV and LAMMPS data, with any bytes at all: refused
/// in one line with the place, or read, and then the ranks' shares together are what one rank reads. The first byte
/// says whether in 2D, the rest is the file.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "fuzz/demand.hpp"
#include "start/text_rows.hpp"

namespace packmpi::fuzz {
namespace {

/// One row as it was read.
struct Row {
  std::int64_t id, line;
  double radius;
  Vec3 position, velocity, spin;
  bool operator==(const Row&) const = default;
};

std::vector<Row> rows_of(const start::TextRows& read) {
  std::vector<Row> rows;
  for (std::size_t k = 0; k < read.rows.id.size(); ++k) {
    rows.push_back({read.rows.id[k], read.line[k], read.rows.radius[k], read.rows.position[k], read.rows.velocity[k],
                    read.rows.spin[k]});
  }
  return rows;
}

void check_rows(const start::TextRows& read) {
  demand(std::cmp_equal(read.total, read.rows.id.size()), "another number of rows than said");
  for (std::size_t k = 0; k < read.rows.id.size(); ++k) {
    const Vec3& x = read.rows.position[k];
    demand(read.rows.radius[k] > 0.0 && std::isfinite(read.rows.radius[k]), "a radius that is none");
    demand(std::ranges::all_of(x, [](double at) { return std::isfinite(at); }), "a position that is none");
  }
}

start::TextRows read(const std::string& path, int dimension, Rank rank, int ranks) {
  return start::kind_of(path) == start::Kind::lammps ? start::read_lammps(path, dimension, rank, ranks)
                                                     : start::read_csv(path, dimension, rank, ranks);
}

void check_refusal(const Error& error, const std::string& path) {
  const std::string words = error.what();
  demand(error.code() == ExitCode::bad_input, "refused with another code than bad_input: " + words);
  demand(words.starts_with(path + ":"), "no place: " + words);
  demand(std::ranges::none_of(words, [](unsigned char c) { return c < 0x20 || c == 0x7f; }), "not one line: " + words);
}

void try_file(const std::string& path, int dimension) {
  if (start::kind_of(path) == start::Kind::pack) return;
  start::TextRows whole;
  try {
    whole = read(path, dimension, 0, 1);
  } catch (const Error& error) {
    return check_refusal(error, path);
  }
  check_rows(whole);
  std::vector<Row> together;
  for (const Rank rank : {0, 1, 2}) {
    const start::TextRows share = read(path, dimension, rank, 3);
    demand(share.total == whole.total && share.taken == whole.taken && share.left == whole.left,
           "ranks read other files");
    const std::vector<Row> rows = rows_of(share);
    together.insert(together.end(), rows.begin(), rows.end());
  }
  std::ranges::sort(together, {}, &Row::id);
  std::vector<Row> alone = rows_of(whole);
  std::ranges::sort(alone, {}, &Row::id);
  demand(together == alone, "the shares of three ranks are not the file");
}

}  // namespace
}  // namespace packmpi::fuzz

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path =
      (std::filesystem::temp_directory_path() / ("packmpi-fuzz-rows-" + std::to_string(getpid()))).string();
  if (size == 0) return 0;
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  packmpi::fuzz::within_a_second([&] { packmpi::fuzz::try_file(path, *data % 2 == 0 ? 3 : 2); });
  return 0;
}
