#include "start/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "start/text_rows.hpp"

namespace packmpi::start {
namespace {

constexpr std::int64_t block_bytes = 1 << 20;
constexpr std::size_t longest_line = 1 << 16;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

[[noreturn]] void refuse_file(const std::string& path, const std::string& words) {
  throw Error(ExitCode::bad_input, fmt::format("{}: {}", path, words));
}

// The next bytes of the file.
std::string part_of(const RegularFile& file, const std::string& path, std::int64_t begin) {
  std::optional<std::string> part = file.read(begin, std::min(block_bytes, file.size() - begin));
  if (!part) refuse_file(path, "cannot be read");
  return std::move(*part);
}

bool tells_atoms(std::string_view line) {
  const std::vector<std::string_view> words = cells_of(line, ' ');
  double count = 0.0;
  return words.size() >= 2 && words[1] == "atoms" && is_number(words[0], false, count);
}

}  // namespace

TextFile::TextFile(const std::string& path) : path_(path), file_(path) {
  if (!file_.flaw().empty()) refuse_file(path, file_.flaw());
}

bool TextFile::refill() {
  if (read_ >= file_.size()) return false;
  block_ = part_of(file_, path_, read_);
  if (read_ == 0 && block_.starts_with(byte_order_mark)) block_.erase(0, byte_order_mark.size());
  read_ += std::min(block_bytes, file_.size() - read_);
  at_ = 0;
  return true;
}

bool TextFile::next(std::string& line) {
  line.clear();
  if (at_ >= block_.size() && !refill()) return false;
  ++number_;
  for (;;) {
    const std::size_t end = block_.find('\n', at_);
    line.append(block_, at_, end == std::string::npos ? std::string::npos : end - at_);
    at_ = end == std::string::npos ? block_.size() : end + 1;
    if (line.size() > longest_line) refuse("has no end in 65536 bytes; this is no table of particles");
    if (end != std::string::npos || !refill()) break;
  }
  if (line.ends_with('\r')) line.pop_back();
  return true;
}

void TextFile::refuse(const std::string& words) const {
  throw Error(ExitCode::bad_input, fmt::format("{}:{}: {}", path_, number_, words));
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator == ' ') {
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t begin = line.find_first_not_of(" \t", at);
      if (begin == std::string_view::npos) break;
      at = std::min(line.find_first_of(" \t", begin), line.size());
      cells.push_back(line.substr(begin, at - begin));
    }
    return cells;
  }
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    cells.push_back(text::trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
  while (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return cells;
}

bool is_number(std::string_view cell, bool comma, double& value) {
  std::string plain;
  if (comma && cell.find(',') != std::string_view::npos) {
    if (cell.find('.') != std::string_view::npos || cell.find(',') != cell.rfind(',')) return false;
    plain = cell;
    plain[plain.find(',')] = '.';
    cell = plain;
  }
  if (cell.starts_with('+')) cell.remove_prefix(1);
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value);
}

Kind kind_of(const std::string& path) {
  const RegularFile file(path);
  if (!file.flaw().empty()) refuse_file(path, file.flaw());
  constexpr std::string_view hdf5 = "\x89HDF\r\n\x1A\n";
  if (part_of(file, path, 0).starts_with(hdf5)) return Kind::pack;
  TextFile text(path);
  std::string line;
  constexpr int head = 40;  // lines
  for (int k = 0; k < head && text.next(line); ++k) {
    if (k > 0 && tells_atoms(line)) return Kind::lammps;
  }
  return Kind::csv;
}

std::uint64_t digest_of_text(const std::string& path) {
  const RegularFile file(path);
  if (!file.flaw().empty()) refuse_file(path, file.flaw());
  std::uint64_t digest = fnv_start;
  for (std::int64_t at = 0; at < file.size(); at += block_bytes) digest = fnv_add(digest, part_of(file, path, at));
  return digest;
}

}  // namespace packmpi::start
