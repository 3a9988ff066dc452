/// HDF5 behind owned handles, every call checked. Private to this module. All of it is rank-local.
#pragma once
#include <hdf5.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "comm/comm.hpp"
#include "disk/attribute.hpp"
#include "disk/files.hpp"

namespace packmpi::disk::h5 {

/// Throws Error(io_failure): what was tried, and HDF5's innermost words.
[[noreturn]] void fail(std::string_view what);

/// Throws as fail() if `status` is negative.
inline void check(herr_t status, std::string_view what) {
  if (status < 0) fail(what);
}

/// An HDF5 object, closed once on every path. Moved, never copied.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Closer closer, std::string_view what);  ///< throws as fail() if `id` is negative
  ~Handle();
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&& other) noexcept;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  [[nodiscard]] hid_t get() const noexcept { return id_; }
  void close(std::string_view what);  ///< close now; throws as fail()

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

/// HDF5 prints no stack of its own while one of these lives; the words go into our errors.
class Quiet {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t printer_ = nullptr;
  void* data_ = nullptr;
};

/// The type of T in memory, which is also the one in the file.
template <class T>
[[nodiscard]] hid_t type_of() {
  if constexpr (std::is_same_v<T, double>) {
    return H5T_NATIVE_DOUBLE;
  } else if constexpr (std::is_same_v<T, std::int64_t>) {
    return H5T_NATIVE_INT64;
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    return H5T_NATIVE_UINT64;
  } else if constexpr (std::is_same_v<T, std::int32_t>) {
    return H5T_NATIVE_INT32;
  } else {
    static_assert(std::is_same_v<T, std::uint8_t>);
    return H5T_NATIVE_UINT8;
  }
}

/// Elements of a row: 1 for a T, N for an array of T.
template <class T, class Row>
inline constexpr std::size_t row_width = 1;
template <class T, std::size_t n>
inline constexpr std::size_t row_width<T, std::array<T, n>> = n;

/// A fixed-length UTF-8 string type that holds `length` bytes without an end mark.
[[nodiscard]] Handle string_type(std::size_t length);

/// A new file named `path`, all of which is written to `memory` instead: where nothing can fail for the disk's sake, so
/// that it can always be closed. (A file that cannot ends the program at its exit: HDF5 1.10 closes it once more.)
[[nodiscard]] Handle create_file(const std::string& path, const MemoryFile& memory);
[[nodiscard]] Handle create_group(hid_t file, const std::string& path);
[[nodiscard]] Handle open_dataset(hid_t file, const std::string& path);
void set_attribute(hid_t object, const char* name, const Value& value);
/// Words as a fixed-length ASCII string without padding, as VTK wants its own; not empty.
void set_fixed_attribute(hid_t object, const char* name, const std::string& words);
void set_attributes(hid_t object, const std::vector<Field>& fields);
void hard_link(hid_t file, const std::string& existing, const std::string& path);

/// A small dataset with its contents; words as fixed-length strings. `unit` "": no unit attribute.
void write_small(hid_t file, const std::string& path, const std::string& unit, const std::vector<double>& values);
void write_small(hid_t file, const std::string& path, const std::string& unit, const std::vector<std::int64_t>& values);
void write_small(hid_t file, const std::string& path, const std::string& unit, const std::vector<std::uint8_t>& values);
void write_small(hid_t file, const std::string& path, const std::string& unit, const std::vector<std::string>& values);

/// Which rows of a dataset this rank holds.
struct Slab {
  hsize_t total, offset, count;
};

/// A dataset to be: rows of `width` elements (width 1: one axis). Of this rank's rows, `held` are at hand, the next
/// ones in the order of the file; `bytes` makes `count` of these, from the `first` of them on.
struct Column {
  std::string path;
  std::string unit;  ///< "": no unit attribute
  Handle type;
  hsize_t width;
  Slab slab;
  std::function<std::size_t()> held;
  std::function<std::vector<std::byte>(std::size_t first, std::size_t count)> bytes;
};

/// Creates the dataset with its space in the file: contiguous, not filled, no rows written.
void create_dataset(hid_t file, const Column& column);

/// Bytes of a row in the file.
[[nodiscard]] std::size_t row_bytes(const Column& column);
/// Where its rows begin in the file [bytes]; 0 if it has none.
[[nodiscard]] std::int64_t place_of(hid_t file, const Column& column);

/// Where in the file this rank's rows begin [bytes], for a dataset that begins at `place`.
[[nodiscard]] std::int64_t place_of_rows(const Column& column, std::int64_t place);

/// A column whose rows are get(rows[k]): a T or an array of T; `rows`, which must live until the column is written, has
/// those at hand.
template <class T, class Row, class Get>
[[nodiscard]] Column make_column(std::string path, std::string unit, const Slab& slab, const std::vector<Row>& rows,
                                 Get get) {
  using Cell = std::decay_t<std::invoke_result_t<Get, const Row&>>;
  static_assert(sizeof(Cell) == sizeof(T) * row_width<T, Cell>);
  auto bytes = [&rows, get](std::size_t first, std::size_t count) {
    std::vector<std::byte> buffer(count * sizeof(Cell));
    for (std::size_t k = 0; k < count; ++k) {
      const Cell cell = get(rows[first + k]);
      const auto* raw = reinterpret_cast<const std::byte*>(&cell);
      std::copy(raw, raw + sizeof cell, buffer.begin() + static_cast<std::ptrdiff_t>(k * sizeof cell));
    }
    return buffer;
  };
  return {std::move(path),
          std::move(unit),
          Handle(H5Tcopy(type_of<T>()), H5Tclose, "copy a type"),
          row_width<T, Cell>,
          slab,
          [&rows] { return rows.size(); },
          std::move(bytes)};
}

}  // namespace packmpi::disk::h5
