/// A file of ours, open for reading. It may come from a stranger, who can seal what he likes: so HDF5 reads nothing of
/// it but what lies in its bytes as we write it.
#pragma once
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "disk/hdf5.hpp"
#include "disk/seal.hpp"

namespace packmpi::disk {

/// Which rows of how many.
struct Range {
  std::int64_t total, begin, count;
};

/// Rank-local; several ranks may each have the same file open. Objects are reached by hard links alone; a dataset has
/// its rows in one piece within the file, of the type that is asked for. What is otherwise, external, virtual, chunked
/// or never written, is refused before any memory is taken for it. Errors: Error(io_failure), words without the path.
class SealedFile {
 public:
  /// Opens it, once all but its rows is known to be what was written.
  explicit SealedFile(const std::string& path);

  [[nodiscard]] const Seal& seal() const noexcept { return seal_; }
  [[nodiscard]] bool has(const std::string& object) const;
  [[nodiscard]] bool has_attribute(const std::string& object, const char* name) const;
  /// Sizes of the axes of a dataset of T.
  template <class T>
  [[nodiscard]] std::vector<hsize_t> extent(const std::string& dataset) const {
    return extent(dataset, h5::type_of<T>());
  }
  /// An attribute that is one number.
  template <class T>
  [[nodiscard]] T number(const std::string& object, const char* attribute) const {
    T value{};
    read_number(object, attribute, h5::type_of<T>(), &value);
    return value;
  }
  /// An attribute that is words of any length.
  [[nodiscard]] std::string text(const std::string& object, const char* attribute) const;
  /// A dataset of bytes.
  [[nodiscard]] std::string bytes(const std::string& dataset) const;
  /// Rows of a dataset of `width` T each; a flat list.
  template <class T>
  [[nodiscard]] std::vector<T> numbers(const std::string& dataset, const Range& range, std::size_t width) const {
    const h5::Handle open = open_rows(dataset, h5::type_of<T>(), range, width);
    std::vector<T> all(static_cast<std::size_t>(range.count) * width);
    read_rows(open.get(), dataset, h5::type_of<T>(), range, width, all.data());
    return all;
  }
  /// The same; `Row` is a T or an array of T.
  template <class T, class Row>
  [[nodiscard]] std::vector<Row> rows(const std::string& dataset, const Range& range) const {
    constexpr std::size_t width = h5::row_width<T, Row>;
    static_assert(sizeof(Row) == width * sizeof(T));
    const h5::Handle open = open_rows(dataset, h5::type_of<T>(), range, width);
    std::vector<Row> all(static_cast<std::size_t>(range.count));
    read_rows(open.get(), dataset, h5::type_of<T>(), range, width, all.data());
    return all;
  }

 private:
  void require(const std::string& object) const;
  [[nodiscard]] h5::Handle open(const std::string& dataset, hid_t type) const;
  [[nodiscard]] std::vector<hsize_t> extent(const std::string& dataset, hid_t type) const;
  [[nodiscard]] h5::Handle open_attribute(const std::string& object, const char* name) const;
  void read_number(const std::string& object, const char* attribute, hid_t type, void* value) const;
  [[nodiscard]] h5::Handle open_rows(const std::string& dataset, hid_t type, const Range& range,
                                     std::size_t width) const;
  static void read_rows(hid_t dataset, const std::string& name, hid_t type, const Range& range, std::size_t width,
                        void* out);

  Seal seal_;
  h5::Handle file_;
};

}  // namespace packmpi::disk
