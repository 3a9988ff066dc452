/// A text file, line by line. Private to this module.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/regular_file.hpp"

namespace packmpi::start {

/// Lines of a file that may be larger than memory. Rank-local. Throws Error(bad_input) if there is no such file.
class TextFile {
 public:
  explicit TextFile(const std::string& path);

  /// The next line, without its end and without a byte-order mark; false: there is none.
  bool next(std::string& line);
  [[nodiscard]] std::int64_t number() const noexcept { return number_; }  ///< of the line last read, from 1
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Throws Error(bad_input): "FILE:LINE: words", of the line last read.
  [[noreturn]] void refuse(const std::string& words) const;

 private:
  bool refill();

  std::string path_;
  RegularFile file_;
  std::string block_;
  std::size_t at_ = 0;     // in block_
  std::int64_t read_ = 0;  // bytes of the file
  std::int64_t number_ = 0;
};

/// Cells of a line; separator ' ': any number of blanks.
[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line, char separator);

/// The number that a cell is, and nothing else: finite. False: it is none. With `comma` a decimal comma is one.
[[nodiscard]] bool is_number(std::string_view cell, bool comma, double& value);

}  // namespace packmpi::start
