#include "disk/hdf5.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"

namespace packmpi::disk::h5 {
namespace {

herr_t keep_words(unsigned /*level*/, const H5E_error2_t* error, void* out) {
  if (error->desc != nullptr && error->desc[0] != '\0') *static_cast<std::string*>(out) = error->desc;
  return 0;  // go on: the innermost words stay
}

Handle plain_space() { return {H5Screate(H5S_SCALAR), H5Sclose, "make a data space"}; }

Handle space_of(const std::vector<hsize_t>& sizes) {
  return {H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose, "make a data space"};
}

void write_attribute(hid_t object, const char* name, hid_t type, const Handle& space, const void* value) {
  const Handle attribute(H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "create an attribute");
  check(H5Awrite(attribute.get(), type, value), "write an attribute");
}

/// Words of any length: h5py gives them back as str.
void set_one(hid_t object, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "copy a type");
  check(H5Tset_size(type.get(), H5T_VARIABLE), "size a string");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "name a character set");
  const char* words = text.c_str();
  write_attribute(object, name, type.get(), plain_space(), &words);
}

void set_one(hid_t object, const char* name, bool value) {
  const std::int64_t number = value ? 1 : 0;
  write_attribute(object, name, H5T_NATIVE_INT64, plain_space(), &number);
}

template <class T>
void set_one(hid_t object, const char* name, const T& value) {
  write_attribute(object, name, type_of<T>(), plain_space(), &value);
}

template <class T>
void set_one(hid_t object, const char* name, const std::vector<T>& values) {
  write_attribute(object, name, type_of<T>(), space_of({values.size()}), values.data());
}

/// A dataset that is as it will be: contiguous, allocated, without times. Empty `sizes` of rows are allowed.
Handle make_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& sizes,
                    const std::string& unit) {
  const Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make dataset properties");
  check(H5Pset_obj_track_times(create.get(), false), "leave out the times");
  check(H5Pset_fill_time(create.get(), H5D_FILL_TIME_NEVER), "leave out the fill");
  check(H5Pset_alloc_time(create.get(), H5D_ALLOC_TIME_EARLY), "allocate early");
  const Handle space = space_of(sizes);
  Handle dataset(H5Dcreate2(file, path.c_str(), type, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT), H5Dclose,
                 "create " + path);
  if (!unit.empty()) set_attribute(dataset.get(), "unit", unit);
  return dataset;
}

void write_all(hid_t file, const std::string& path, const std::string& unit, hid_t type, std::size_t count,
               const void* values) {
  Handle dataset = make_dataset(file, path, type, {count}, unit);
  if (count > 0) check(H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write " + path);
  dataset.close("close " + path);  // small ones are written only now
}

}  // namespace

void fail(std::string_view what) {
  std::string words;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_words, &words);
  throw Error(ExitCode::io_failure,
              fmt::format("HDF5 could not {}: {}", what, words.empty() ? "no reason given" : words));
}

Handle::Handle(hid_t id, Closer closer, std::string_view what) : id_(id), closer_(closer) {
  if (id_ < 0) fail(what);
}

Handle::~Handle() {
  if (id_ >= 0) closer_(id_);
}

Handle::Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), closer_(other.closer_) {}

Handle& Handle::operator=(Handle&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(closer_, other.closer_);
  return *this;
}

void Handle::close(std::string_view what) { check(closer_(std::exchange(id_, H5I_INVALID_HID)), what); }

Quiet::Quiet() {
  H5Eget_auto2(H5E_DEFAULT, &printer_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Quiet::~Quiet() { H5Eset_auto2(H5E_DEFAULT, printer_, data_); }

Handle string_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "copy a type");
  check(H5Tset_size(type.get(), std::max<std::size_t>(length, 1)), "size a string");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "pad a string");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "name a character set");
  return type;
}

Handle create_file(const std::string& path, const MemoryFile& memory) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make access properties");
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V110), "choose a version");
  const Handle create(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "make file properties");
  check(H5Pset_obj_track_times(create.get(), false), "leave out the times");  // of the root group
  check(H5Pset_fapl_sec2(access.get()), "choose a driver");
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, create.get(), access.get()), H5Fclose, "create the file");
  int* descriptor = nullptr;  // nothing has been written to it yet
  check(H5Fget_vfd_handle(file.get(), access.get(), reinterpret_cast<void**>(&descriptor)), "name its descriptor");
  if (!memory.stand_in_for(*descriptor)) fail("go on in memory");
  return file;
}

Handle create_group(hid_t file, const std::string& path) {
  const Handle create(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "make group properties");
  check(H5Pset_obj_track_times(create.get(), false), "leave out the times");
  return {H5Gcreate2(file, path.c_str(), H5P_DEFAULT, create.get(), H5P_DEFAULT), H5Gclose, "create " + path};
}

Handle open_dataset(hid_t file, const std::string& path) {
  return {H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path};
}

void set_attribute(hid_t object, const char* name, const Value& value) {
  std::visit([&](const auto& v) { set_one(object, name, v); }, value);
}

void set_fixed_attribute(hid_t object, const char* name, const std::string& words) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "copy a type");
  check(H5Tset_size(type.get(), words.size()), "size a string");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "pad a string");
  write_attribute(object, name, type.get(), plain_space(), words.data());
}

void set_attributes(hid_t object, const std::vector<Field>& fields) {
  for (const Field& field : fields) set_attribute(object, field.name, field.value);
}

void hard_link(hid_t file, const std::string& existing, const std::string& path) {
  check(H5Lcreate_hard(file, existing.c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT), "link " + path);
}

void write_small(hid_t file, const std::string& path, const std::string& unit, const std::vector<double>& values) {
  write_all(file, path, unit, type_of<double>(), values.size(), values.data());
}

void write_small(hid_t file, const std::string& path, const std::string& unit,
                 const std::vector<std::int64_t>& values) {
  write_all(file, path, unit, type_of<std::int64_t>(), values.size(), values.data());
}

void write_small(hid_t file, const std::string& path, const std::string& unit,
                 const std::vector<std::uint8_t>& values) {
  write_all(file, path, unit, type_of<std::uint8_t>(), values.size(), values.data());
}

void write_small(hid_t file, const std::string& path, const std::string& unit, const std::vector<std::string>& values) {
  std::size_t length = 1;
  for (const std::string& value : values) length = std::max(length, value.size());
  std::vector<char> text(values.size() * length);  // zero padded
  for (std::size_t k = 0; k < values.size(); ++k) std::copy(values[k].begin(), values[k].end(), &text[k * length]);
  write_all(file, path, unit, string_type(length).get(), values.size(), text.data());
}

void create_dataset(hid_t file, const Column& column) {
  std::vector<hsize_t> sizes{column.slab.total};
  if (column.width > 1) sizes.push_back(column.width);
  (void)make_dataset(file, column.path, column.type.get(), sizes, column.unit);
}

std::size_t row_bytes(const Column& column) { return column.width * H5Tget_size(column.type.get()); }

std::int64_t place_of(hid_t file, const Column& column) {
  if (column.slab.total == 0) return 0;  // has no place in the file
  const Handle dataset(H5Dopen2(file, column.path.c_str(), H5P_DEFAULT), H5Dclose, "open " + column.path);
  const haddr_t place = H5Dget_offset(dataset.get());
  if (place == HADDR_UNDEF) fail("place " + column.path);
  return static_cast<std::int64_t>(place);
}

std::int64_t place_of_rows(const Column& column, std::int64_t place) {
  return place + static_cast<std::int64_t>(column.slab.offset * hsize_t{row_bytes(column)});
}

}  // namespace packmpi::disk::h5
