#include <fmt/format.h>

#include <cstring>

#include "output/hdf5.hpp"
#include "output/pack.hpp"

namespace packmpi::output {
namespace {

/// Sizes of a dataset's axes.
std::vector<hsize_t> extent(hid_t dataset) {
  const h5::Handle space(H5Dget_space(dataset), H5Sclose, "ask for a data space");
  const int axes = H5Sget_simple_extent_ndims(space.get());
  if (axes < 0) h5::fail("ask for an extent");
  std::vector<hsize_t> sizes(static_cast<std::size_t>(axes));
  h5::check(H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr), "ask for an extent");
  return sizes;
}

/// A dataset of rows of `Row`, which is a T or an array of T.
template <class T, class Row>
std::vector<Row> read_rows(hid_t file, const std::string& path, std::size_t count) {
  const h5::Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
  std::vector<hsize_t> expected{count};
  if (h5::row_width < T, Row >> 1) expected.push_back(h5::row_width<T, Row>);
  if (extent(dataset.get()) != expected) {
    throw Error(ExitCode::io_failure, fmt::format("{} has another shape than a pack of {} particles", path, count));
  }
  std::vector<Row> rows(count);
  if (count > 0) {
    h5::check(H5Dread(dataset.get(), h5::type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), "read " + path);
  }
  return rows;
}

std::int64_t read_integer(hid_t file, const char* object, const char* name) {
  const h5::Handle attribute(H5Aopen_by_name(file, object, name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                             fmt::format("open the attribute {} of {}", name, object));
  std::int64_t value = 0;
  h5::check(H5Aread(attribute.get(), H5T_NATIVE_INT64, &value), fmt::format("read the attribute {}", name));
  return value;
}

PackRows read_file(const std::string& path) {
  const h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open it");
  if (const std::int64_t version = read_integer(file.get(), "/", "format_version"); version != 1) {
    throw Error(ExitCode::io_failure, fmt::format("format version {} is not known here", version));
  }
  PackRows pack;
  pack.dimension = static_cast<int>(read_integer(file.get(), "/summary", "dimension"));
  std::size_t count = 0;
  {
    const h5::Handle ids(H5Dopen2(file.get(), "/particles/id", H5P_DEFAULT), H5Dclose, "open /particles/id");
    const std::vector<hsize_t> sizes = extent(ids.get());
    if (sizes.size() == 1) count = sizes[0];  // any other shape is refused by the read
  }
  pack.id = read_rows<std::int64_t, GlobalId>(file.get(), "/particles/id", count);
  pack.position = read_rows<double, Vec3>(file.get(), "/particles/position", count);
  pack.radius = read_rows<double, double>(file.get(), "/particles/radius", count);
  pack.velocity = read_rows<double, Vec3>(file.get(), "/particles/velocity", count);
  if (H5Lexists(file.get(), "/particles/spin", H5P_DEFAULT) > 0) {
    pack.spin = read_rows<double, Vec3>(file.get(), "/particles/spin", count);
  }
  pack.layer = read_rows<std::int32_t, std::int32_t>(file.get(), "/particles/layer", count);
  pack.contacts = read_rows<std::int32_t, std::int32_t>(file.get(), "/particles/contacts", count);
  return pack;
}

}  // namespace

bool is_pack(const std::string& path) {
  const h5::Quiet quiet;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) return false;
  const bool pack = H5Lexists(file, "/summary", H5P_DEFAULT) > 0;
  H5Fclose(file);
  return pack;
}

PackRows read_pack(const std::string& path) {
  const h5::Quiet quiet;
  try {
    return read_file(path);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("cannot read {}: {}", path, error.what()));
  }
}

}  // namespace packmpi::output
