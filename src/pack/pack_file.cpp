#include "pack/pack_file.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "pack/former_names.hpp"

namespace packmpi::pack {
namespace {

/// Sizes of a dataset's axes.
std::vector<hsize_t> extent(hid_t dataset) {
  const disk::h5::Handle space(H5Dget_space(dataset), H5Sclose, "ask for a data space");
  const int axes = H5Sget_simple_extent_ndims(space.get());
  if (axes < 0) disk::h5::fail("ask for an extent");
  std::vector<hsize_t> sizes(static_cast<std::size_t>(axes));
  disk::h5::check(H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr), "ask for an extent");
  return sizes;
}

disk::h5::Handle open_attribute(hid_t file, const char* object, const char* name) {
  return {H5Aopen_by_name(file, object, name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
          fmt::format("open the attribute {} of {}", name, object)};
}

/// An attribute that is one number.
template <class T>
T read_number(hid_t file, const char* object, const char* name) {
  const disk::h5::Handle attribute = open_attribute(file, object, name);
  const disk::h5::Handle space(H5Aget_space(attribute.get()), H5Sclose, "ask for a data space");
  if (H5Sget_simple_extent_npoints(space.get()) != 1) {
    throw Error(ExitCode::io_failure, fmt::format("the attribute {} of {} is no single number", name, object));
  }
  T value{};
  disk::h5::check(H5Aread(attribute.get(), disk::h5::type_of<T>(), &value), fmt::format("read the attribute {}", name));
  return value;
}

/// Which rows of how many.
struct Range {
  std::int64_t total, begin;
  std::size_t count;
};

/// Rows of a dataset; `Row` is a T or an array of T.
template <class T, class Row>
std::vector<Row> read_rows(hid_t file, const std::string& path, const Range& range) {
  constexpr hsize_t width = disk::h5::row_width<T, Row>;
  const disk::h5::Handle dataset = disk::h5::open_dataset(file, path);
  std::vector<hsize_t> expected{static_cast<hsize_t>(range.total)};
  if (width > 1) expected.push_back(width);
  if (extent(dataset.get()) != expected) {
    throw Error(ExitCode::io_failure,
                fmt::format("{} has another shape than a pack of {} particles", path, range.total));
  }
  std::vector<Row> rows(range.count);
  if (range.count == 0) return rows;
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(range.begin), 0};
  const std::array<hsize_t, 2> count{range.count, width};
  const disk::h5::Handle there(H5Dget_space(dataset.get()), H5Sclose, "ask for a data space");
  disk::h5::check(H5Sselect_hyperslab(there.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
                  "select rows");
  const hsize_t elements = range.count * width;
  const disk::h5::Handle here(H5Screate_simple(1, &elements, nullptr), H5Sclose, "make a data space");
  disk::h5::check(H5Dread(dataset.get(), disk::h5::type_of<T>(), here.get(), there.get(), H5P_DEFAULT, rows.data()),
                  "read " + path);
  return rows;
}

}  // namespace

PackFile::PackFile(const std::string& path)
    : seal_(disk::check_frame(path)), file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open it") {
  version_ = read_number<std::int64_t>(file_.get(), "/", "format_version");
  if (version_ < oldest_pack_version || version_ > pack_version) {
    throw Error(ExitCode::io_failure,
                fmt::format("it has format version {}, and this packmpi reads {} to {}: use the packmpi that wrote it",
                            version_, oldest_pack_version, pack_version));
  }
  dimension_ = static_cast<int>(read_number<std::int64_t>(file_.get(), "/summary", "dimension"));
  const std::vector<hsize_t> sizes = extent(disk::h5::open_dataset(file_.get(), "/particles/id").get());
  if (sizes.size() == 1) count_ = static_cast<std::int64_t>(sizes[0]);  // any other shape is refused by the read
  rotation_ = H5Lexists(file_.get(), "/particles/spin", H5P_DEFAULT) > 0;
}

PackRows PackFile::rows(std::int64_t begin, std::int64_t count) const {
  const Range range{count_, begin, static_cast<std::size_t>(count)};
  const hid_t file = file_.get();
  PackRows pack;
  pack.dimension = dimension_;
  pack.id = read_rows<std::int64_t, GlobalId>(file, "/particles/id", range);
  pack.position = read_rows<double, Vec3>(file, "/particles/position", range);
  pack.radius = read_rows<double, double>(file, "/particles/radius", range);
  pack.velocity = read_rows<double, Vec3>(file, "/particles/velocity", range);
  if (rotation_) pack.spin = read_rows<double, Vec3>(file, "/particles/spin", range);
  pack.layer = read_rows<std::int32_t, std::int32_t>(file, "/particles/layer", range);
  pack.contacts = read_rows<std::int32_t, std::int32_t>(file, "/particles/contacts", range);
  return pack;
}

std::string PackFile::scene() const {
  const std::string scene = text("/provenance", "effective_input");
  return version_ < pack_version ? scene_in_present_names(scene) : scene;
}

std::string PackFile::text(const char* object, const char* attribute) const {
  const disk::h5::Handle open = open_attribute(file_.get(), object, attribute);
  const disk::h5::Handle type(H5Aget_type(open.get()), H5Tclose, "ask for a type");
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) <= 0) {
    throw Error(ExitCode::io_failure, fmt::format("the attribute {} of {} is no text", attribute, object));
  }
  char* words = nullptr;
  disk::h5::check(H5Aread(open.get(), type.get(), static_cast<void*>(&words)),
                  fmt::format("read the attribute {}", attribute));
  std::string text = words == nullptr ? "" : words;
  H5free_memory(words);
  return text;
}

double PackFile::number(const char* object, const char* attribute) const {
  return read_number<double>(file_.get(), object, attribute);
}

}  // namespace packmpi::pack
