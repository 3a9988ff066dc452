#include "mesh/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"

namespace packmpi::mesh {
namespace {

constexpr std::size_t stl_head = 84, stl_row = 50;  // bytes of binary STL: header and count; a triangle

static_assert(std::endian::native == std::endian::little);

[[noreturn]] void refuse_mesh(const std::string& path, const std::string& words) {
  throw Error(ExitCode::bad_input, fmt::format("{}: {}", path, words));
}

std::string lower(std::string_view word) {
  std::string text(word);
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

void check_count(const std::string& path, std::int64_t count) {
  if (count > most_triangles) {
    refuse_mesh(path, fmt::format("it has {} triangles or more, and {} are the limit; simplify the surface", count,
                                  most_triangles));
  }
}

/// The double that a file meant whose writer had single precision only.
double decimal_of(float x) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr;
  double value = 0.0;
  std::from_chars(digits.data(), end, value);
  return value;
}

std::vector<Corners> read_binary(std::string_view bytes, const std::string& path, std::uint32_t count) {
  check_count(path, count);
  std::vector<Corners> found(count);
  for (std::size_t t = 0; t < count; ++t) {
    std::array<float, 12> row{};  // the normal first: it is worked out anew
    std::memcpy(row.data(), bytes.data() + stl_head + t * stl_row, sizeof row);
    for (std::size_t k = 0; k < 9; ++k) {
      const float x = row.at(3 + k);
      if (!std::isfinite(x)) refuse_mesh(path, fmt::format("triangle {} has a corner that is no number", t + 1));
      found[t].at(k / 3).at(k % 3) = decimal_of(x);
    }
  }
  return found;
}

/// Words of a text, line by line.
class Words {
 public:
  Words(std::string_view text, const std::string& path) : text_(text), path_(&path) {}

  /// The next word; none: the end.
  std::optional<std::string_view> next() {
    for (; at_ < text_.size() && is_blank(text_[at_]); ++at_) line_ += static_cast<int>(text_[at_] == '\n');
    return take();
  }
  /// The next word of this line.
  std::optional<std::string_view> next_here() {
    while (at_ < text_.size() && text_[at_] != '\n' && is_blank(text_[at_])) ++at_;
    return at_ < text_.size() && text_[at_] == '\n' ? std::nullopt : take();
  }
  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }
  double number(std::optional<std::string_view> word) {
    double value = 0.0;
    std::string_view rest = word.value_or("");
    if (rest.starts_with('+')) rest.remove_prefix(1);
    const auto [end, flaw] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (flaw != std::errc{} || end != rest.data() + rest.size() || !std::isfinite(value)) {
      refuse(fmt::format("\"{}\" is no number", show(word)));
    }
    return value;
  }
  [[noreturn]] void refuse(const std::string& words) const {
    refuse_mesh(*path_, fmt::format("line {}: {}", line_, words));
  }
  static std::string show(std::optional<std::string_view> word) {
    return word ? text::printable(word->substr(0, 30)) : "the end";
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }
  std::optional<std::string_view> take() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    if (at_ == begin) return std::nullopt;
    return text_.substr(begin, at_ - begin);
  }

  std::string_view text_;
  const std::string* path_;
  std::size_t at_ = 0;
  int line_ = 1;
};

void read_facet(Words& words, Corners& corners) {
  const auto expect = [&](std::string_view name) {
    const auto word = words.next();
    if (lower(word.value_or("")) != name) words.refuse(fmt::format("\"{}\" where {} belongs", Words::show(word), name));
  };
  expect("normal");
  for (int k = 0; k < 3; ++k) (void)words.next();  // worked out anew: many files have nonsense here
  expect("outer"), expect("loop");
  for (Vec3& corner : corners) {
    expect("vertex");
    for (double& x : corner) x = words.number(words.next());
  }
  expect("endloop"), expect("endfacet");
}

std::vector<Corners> read_text_stl(std::string_view bytes, const std::string& path) {
  std::vector<Corners> found;
  Words words(bytes, path);
  while (const auto word = words.next()) {
    const std::string name = lower(*word);
    if (name == "solid" || name == "endsolid") {
      words.skip_line();
    } else if (name == "facet") {
      read_facet(words, found.emplace_back());
      check_count(path, static_cast<std::int64_t>(found.size()));
    } else {
      words.refuse(fmt::format("\"{}\" where facet or endsolid belongs", Words::show(word)));
    }
  }
  return found;
}

/// A binary file may begin with "solid", too: what decides is whether its count of triangles agrees with its size.
std::vector<Corners> read_stl(std::string_view bytes, const std::string& path) {
  std::uint32_t count = 0;
  if (bytes.size() >= stl_head) std::memcpy(&count, bytes.data() + stl_head - sizeof count, sizeof count);
  const std::size_t size = stl_head + stl_row * std::size_t{count};
  if (bytes.size() >= stl_head && bytes.size() == size) return read_binary(bytes, path, count);
  const bool binary = bytes.find('\0') != std::string_view::npos;
  const std::size_t first = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  if (!binary && lower(bytes.substr(first, 5)) == "solid") return read_text_stl(bytes, path);
  if (binary && bytes.size() >= stl_head) {
    refuse_mesh(path, fmt::format("as binary STL it says {} triangles and so has to have {} bytes, not {}; it is cut "
                                  "short or damaged",
                                  count, size, bytes.size()));
  }
  refuse_mesh(path, "it is no STL file: neither text that begins with \"solid\" nor binary");
}

/// "7", "7/2/3", "-1": the corner of a face of OBJ.
std::size_t point_of(Words& words, std::string_view word, std::size_t points) {
  const std::string_view digits = word.substr(0, std::min(word.find('/'), word.size()));
  std::int64_t number = 0;
  const auto [end, flaw] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (number < 0) number += static_cast<std::int64_t>(points) + 1;
  if (flaw != std::errc{} || end != digits.data() + digits.size() || number < 1 ||
      number > static_cast<std::int64_t>(points)) {
    words.refuse(fmt::format("\"{}\" is none of the {} vertices before it", Words::show(word), points));
  }
  return static_cast<std::size_t>(number - 1);
}

std::vector<Corners> read_obj(std::string_view bytes, const std::string& path) {
  constexpr std::array<std::string_view, 11> passed{"vt",     "vn", "o", "g",  "s",    "usemtl",
                                                    "mtllib", "l",  "p", "mg", "bevel"};
  std::vector<Corners> found;
  std::vector<Vec3> points;
  Words words(bytes, path);
  while (const auto word = words.next()) {
    if (*word == "v") {
      for (double& x : points.emplace_back()) x = words.number(words.next_here());
    } else if (*word == "f") {
      std::vector<std::size_t> face;
      while (const auto corner = words.next_here()) face.push_back(point_of(words, *corner, points.size()));
      if (face.size() < 3) words.refuse("a face has three corners or more");
      for (std::size_t k = 1; k + 1 < face.size(); ++k) {
        found.push_back({points[face[0]], points[face[k]], points[face[k + 1]]});
      }
      check_count(path, static_cast<std::int64_t>(found.size()));
    } else if (!word->starts_with('#') && std::ranges::find(passed, *word) == passed.end()) {
      words.refuse(fmt::format("\"{}\" is nothing that is read from OBJ files: vertices (v) and faces (f) are",
                               Words::show(word)));
    }
    words.skip_line();
  }
  return found;
}

}  // namespace

bool names_mesh(std::string_view path) noexcept {
  const auto ends = [&](std::string_view ending) {
    return path.size() > ending.size() &&
           std::ranges::equal(path.substr(path.size() - ending.size()), ending,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
  };
  return ends(".stl") || ends(".obj");
}

std::vector<Corners> read_triangles(std::string_view bytes, const std::string& path) {
  if (!names_mesh(path)) refuse_mesh(path, "a surface is read from files that end in .stl or .obj");
  if (static_cast<std::int64_t>(bytes.size()) > most_bytes) {
    refuse_mesh(path, fmt::format("it has {}, and {} are the limit; simplify the surface", text::bytes(bytes.size()),
                                  text::bytes(most_bytes)));
  }
  std::vector<Corners> found =
      lower(path.substr(path.size() - 4)) == ".stl" ? read_stl(bytes, path) : read_obj(bytes, path);
  if (found.empty()) refuse_mesh(path, "it has no triangle");
  return found;
}

std::string binary_stl(const std::vector<Corners>& triangles) {
  std::string bytes(stl_head + stl_row * triangles.size(), '\0');
  const std::string_view head = "binary STL";
  std::memcpy(bytes.data(), head.data(), head.size());
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::memcpy(bytes.data() + stl_head - sizeof count, &count, sizeof count);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::array<float, 12> row{};
    for (std::size_t k = 0; k < 9; ++k) row.at(3 + k) = static_cast<float>(triangles[t].at(k / 3).at(k % 3));
    std::memcpy(bytes.data() + stl_head + t * stl_row, row.data(), sizeof row);
  }
  return bytes;
}

}  // namespace packmpi::mesh
