#include "disk/seal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "disk/scatter.hpp"

namespace packmpi::disk {
namespace {

// The seal: four numbers a column, the number of columns, end, frame, the digest of all these, and the mark. Numbers
// are of 64 bits, as all of the file little-endian.
constexpr std::string_view mark = "packmpi-seal-v1\n";
constexpr std::int64_t number_bytes = 8, column_bytes = 4 * number_bytes;
constexpr std::int64_t tail_bytes = 4 * number_bytes + static_cast<std::int64_t>(mark.size());
constexpr std::int64_t most_columns = 64;
constexpr std::int64_t batch_bytes = std::int64_t{1} << 20;

[[noreturn]] void refuse_seal(const std::string& words) { throw Error(ExitCode::io_failure, words); }

[[noreturn]] void refuse_seal() {
  refuse_seal(
      "there is no valid seal at its end: it is cut off, damaged, not a file of packmpi, or of another version");
}

[[noreturn]] void refuse_contents() {
  refuse_seal("it is not what was written: the file is damaged, or was changed by another program");
}

/// The file as numbers of bytes; what cannot be read is not there.
class Bytes {
 public:
  explicit Bytes(const std::string& path) : file_(path) {
    if (!file_.flaw().empty()) refuse_seal("it " + file_.flaw());
  }
  [[nodiscard]] std::int64_t size() const { return file_.size(); }
  [[nodiscard]] std::string read(std::int64_t begin, std::int64_t size) const {
    std::optional<std::string> bytes = file_.read(begin, size);
    if (!bytes || static_cast<std::int64_t>(bytes->size()) != size) refuse_seal("it cannot be read to its end");
    return std::move(*bytes);
  }

 private:
  RegularFile file_;
};

template <class Number>
void put(std::string& bytes, Number number) {
  static_assert(sizeof number == number_bytes);
  std::array<char, sizeof number> raw{};
  std::memcpy(raw.data(), &number, sizeof number);
  bytes.append(raw.data(), raw.size());
}

std::uint64_t take(std::string_view& bytes) {
  std::uint64_t number = 0;
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes.remove_prefix(sizeof number);
  return number;
}

std::int64_t take_size(std::string_view& bytes) { return static_cast<std::int64_t>(take(bytes)); }

/// The columns in the order of the file; refused unless they are in it and apart.
std::vector<SealedRows> in_order(const Seal& seal) {
  std::vector<SealedRows> columns = seal.columns;
  std::erase_if(columns, [](const SealedRows& column) { return column.rows == 0; });
  std::ranges::sort(columns, {}, &SealedRows::place);
  std::int64_t before = 0;
  for (const SealedRows& column : columns) {
    const bool positive = column.rows > 0 && column.row_bytes > 0 && column.place >= before;
    if (!positive || column.place > seal.end || column.rows > (seal.end - column.place) / column.row_bytes) {
      refuse_seal();
    }
    before = column.place + column.rows * column.row_bytes;
  }
  return columns;
}

Seal read_seal(const Bytes& file) {
  if (file.size() < tail_bytes) refuse_seal();
  const std::string tail = file.read(file.size() - tail_bytes, tail_bytes);
  if (!tail.ends_with(mark)) refuse_seal();
  std::string_view rest = tail;
  const std::int64_t count = take_size(rest);
  if (count < 0 || count > most_columns || file.size() < count * column_bytes + tail_bytes) refuse_seal();
  const std::int64_t begin = file.size() - tail_bytes - count * column_bytes;
  const std::string table = file.read(begin, count * column_bytes);
  Seal seal;
  seal.end = take_size(rest);
  seal.frame = take(rest);
  const std::string_view before_digest(tail.data(), static_cast<std::size_t>(3 * number_bytes));
  if (take(rest) != fnv_add(fnv_add(fnv_start, table), before_digest) || seal.end != begin) refuse_seal();
  rest = table;
  for (std::int64_t k = 0; k < count; ++k) {
    SealedRows column;
    column.place = take_size(rest);
    column.rows = take_size(rest);
    column.row_bytes = take_size(rest);
    column.digest = take(rest);
    seal.columns.push_back(column);
  }
  return seal;
}

}  // namespace

std::uint64_t rows_digest(std::span<const std::byte> bytes, std::size_t row_bytes, std::int64_t first_row) {
  std::uint64_t sum = 0;
  for (auto row = static_cast<std::uint64_t>(first_row); !bytes.empty(); ++row, bytes = bytes.subspan(row_bytes)) {
    std::uint64_t hash = stir(row);
    for (std::size_t at = 0; at < row_bytes; at += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + at, std::min(sizeof word, row_bytes - at));
      hash = stir(hash ^ word);
    }
    sum += hash;
  }
  return sum;
}

std::uint64_t frame_digest(const Seal& seal, const ReadBytes& read) {
  std::uint64_t hash = fnv_start;
  std::int64_t done = 0;
  const auto add = [&](std::int64_t end) {
    for (; done < end; done += std::min(batch_bytes, end - done)) {
      hash = fnv_add(hash, read(done, std::min(batch_bytes, end - done)));
    }
  };
  for (const SealedRows& column : in_order(seal)) {
    add(column.place);
    done = column.place + column.rows * column.row_bytes;
  }
  add(seal.end);
  return hash;
}

std::string to_bytes(const Seal& seal) {
  std::string bytes;
  for (const SealedRows& column : seal.columns) {
    put(bytes, column.place);
    put(bytes, column.rows);
    put(bytes, column.row_bytes);
    put(bytes, column.digest);
  }
  put(bytes, static_cast<std::int64_t>(seal.columns.size()));
  put(bytes, seal.end);
  put(bytes, seal.frame);
  put(bytes, fnv_add(fnv_start, bytes));
  return bytes + std::string(mark);
}

std::uint64_t digest_of(const Seal& seal) { return fnv_add(fnv_start, to_bytes(seal)); }

Seal check_frame(const std::string& path) {
  const Bytes file(path);
  Seal seal = read_seal(file);
  const auto read = [&file](std::int64_t begin, std::int64_t size) { return file.read(begin, size); };
  if (frame_digest(seal, read) != seal.frame) refuse_contents();
  return seal;
}

std::vector<std::int64_t> row_digests(const std::string& path, const Seal& seal, Rank rank, int ranks) {
  const Bytes file(path);
  std::vector<std::int64_t> digests;
  for (const SealedRows& column : seal.columns) {
    const IdBlocks share{column.rows, ranks};
    const std::int64_t batch = std::max<std::int64_t>(batch_bytes / std::max<std::int64_t>(column.row_bytes, 1), 1);
    std::uint64_t sum = 0;
    for (std::int64_t row = share.begin(rank), end = share.begin(rank + 1); row < end; row += batch) {
      const std::int64_t size = std::min(batch, end - row) * column.row_bytes;
      const std::string bytes = file.read(column.place + row * column.row_bytes, size);
      sum += rows_digest(std::as_bytes(std::span(bytes)), static_cast<std::size_t>(column.row_bytes), row);
    }
    digests.push_back(static_cast<std::int64_t>(sum));
  }
  return digests;
}

void check_rows(const Seal& seal, std::span<const std::int64_t> digests) {
  for (std::size_t k = 0; k < seal.columns.size(); ++k) {
    if (static_cast<std::uint64_t>(digests[k]) != seal.columns[k].digest) refuse_contents();
  }
}

}  // namespace packmpi::disk
