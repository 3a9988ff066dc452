#include "disk/sealed_file.hpp"

#include <fmt/format.h>

#include <array>

#include "base/error.hpp"

namespace packmpi::disk {
namespace {

[[noreturn]] void refuse(const std::string& words) { throw Error(ExitCode::io_failure, words); }

h5::Handle space_of(hid_t dataset) { return {H5Dget_space(dataset), H5Sclose, "ask for a data space"}; }

std::vector<hsize_t> sizes_of(hid_t dataset) {
  const h5::Handle space = space_of(dataset);
  const int axes = H5Sget_simple_extent_ndims(space.get());
  if (axes < 0) h5::fail("ask for an extent");
  std::vector<hsize_t> sizes(static_cast<std::size_t>(axes));
  h5::check(H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr), "ask for an extent");
  return sizes;
}

/// Elements of these axes, at most `most`; more are `most` + 1.
hsize_t elements(const std::vector<hsize_t>& sizes, hsize_t most) {
  hsize_t count = 1;
  for (const hsize_t size : sizes) {
    if (size == 0) return 0;
    count = count > most / size ? most + 1 : count * size;
  }
  return count;
}

bool same_type(const h5::Handle& there, hid_t type) { return H5Tequal(there.get(), type) > 0; }

}  // namespace

SealedFile::SealedFile(const std::string& path)
    : seal_(check_frame(path)), file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open it") {}

// A link on the way may be soft, or lead into another file: neither is ours.
bool SealedFile::has(const std::string& object) const {
  for (std::size_t end = object.find('/', 1);; end = object.find('/', end + 1)) {
    const std::string part = object.substr(0, end);
    if (part == "/") return true;
    if (H5Lexists(file_.get(), part.c_str(), H5P_DEFAULT) <= 0) return false;
    H5L_info_t link{};
    h5::check(H5Lget_info(file_.get(), part.c_str(), &link, H5P_DEFAULT), "look at the link " + part);
    if (link.type != H5L_TYPE_HARD) refuse(part + " is a link to somewhere else, which packmpi never writes");
    if (end == std::string::npos) return true;
  }
}

void SealedFile::require(const std::string& object) const {
  if (!has(object)) refuse(object + " is missing");
}

bool SealedFile::has_attribute(const std::string& object, const char* name) const {
  return has(object) && H5Aexists_by_name(file_.get(), object.c_str(), name, H5P_DEFAULT) > 0;
}

// The layout first: to ask a virtual dataset for its extent can open other files.
h5::Handle SealedFile::open(const std::string& dataset, hid_t type) const {
  require(dataset);
  h5::Handle open = h5::open_dataset(file_.get(), dataset);
  const h5::Handle made(H5Dget_create_plist(open.get()), H5Pclose, "ask how a dataset is stored");
  if (H5Pget_layout(made.get()) != H5D_CONTIGUOUS || H5Pget_external_count(made.get()) != 0) {
    refuse(dataset + " is not in one piece in this file, as packmpi writes it");
  }
  const h5::Handle there(H5Dget_type(open.get()), H5Tclose, "ask for a type");
  if (!same_type(there, type)) refuse(dataset + " has another type of numbers than it should");
  const auto end = static_cast<hsize_t>(seal_.end);
  const hsize_t most = end / H5Tget_size(type);
  const hsize_t count = elements(sizes_of(open.get()), most);
  if (count == 0) return open;
  const haddr_t place = H5Dget_offset(open.get());
  if (count > most || place == HADDR_UNDEF || place > end || count * H5Tget_size(type) > end - place) {
    refuse(dataset + " is larger than what is in the file");
  }
  return open;
}

std::vector<hsize_t> SealedFile::extent(const std::string& dataset, hid_t type) const {
  return sizes_of(open(dataset, type).get());
}

h5::Handle SealedFile::open_attribute(const std::string& object, const char* name) const {
  require(object);
  h5::Handle attribute(H5Aopen_by_name(file_.get(), object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                       fmt::format("open the attribute {} of {}", name, object));
  const h5::Handle space(H5Aget_space(attribute.get()), H5Sclose, "ask for a data space");
  if (H5Sget_simple_extent_npoints(space.get()) != 1) {
    refuse(fmt::format("the attribute {} of {} is no single value", name, object));
  }
  return attribute;
}

void SealedFile::read_number(const std::string& object, const char* attribute, hid_t type, void* value) const {
  const h5::Handle open = open_attribute(object, attribute);
  const h5::Handle there(H5Aget_type(open.get()), H5Tclose, "ask for a type");
  if (!same_type(there, type)) refuse(fmt::format("the attribute {} of {} is no such number", attribute, object));
  h5::check(H5Aread(open.get(), type, value), fmt::format("read the attribute {}", attribute));
}

std::string SealedFile::text(const std::string& object, const char* attribute) const {
  const h5::Handle open = open_attribute(object, attribute);
  const h5::Handle type(H5Aget_type(open.get()), H5Tclose, "ask for a type");
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) <= 0) {
    refuse(fmt::format("the attribute {} of {} is no text", attribute, object));
  }
  char* words = nullptr;
  h5::check(H5Aread(open.get(), type.get(), static_cast<void*>(&words)),
            fmt::format("read the attribute {}", attribute));
  std::string text = words == nullptr ? "" : words;
  H5free_memory(words);
  return text;
}

std::string SealedFile::bytes(const std::string& dataset) const {
  const std::vector<hsize_t> sizes = extent<std::uint8_t>(dataset);
  if (sizes.size() != 1) refuse(dataset + " has another shape than it should");
  const auto size = static_cast<std::int64_t>(sizes[0]);
  const std::vector<std::uint8_t> all = numbers<std::uint8_t>(dataset, {size, 0, size}, 1);
  return {all.begin(), all.end()};
}

h5::Handle SealedFile::open_rows(const std::string& dataset, hid_t type, const Range& range, std::size_t width) const {
  h5::Handle open = this->open(dataset, type);
  std::vector<hsize_t> expected{static_cast<hsize_t>(range.total)};
  if (width > 1) expected.push_back(width);
  if (sizes_of(open.get()) != expected) {
    refuse(fmt::format("{} has another shape than that of {} particles", dataset, range.total));
  }
  return open;
}

void SealedFile::read_rows(hid_t dataset, const std::string& name, hid_t type, const Range& range, std::size_t width,
                           void* out) {
  if (range.count == 0) return;
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(range.begin), 0};
  const std::array<hsize_t, 2> count{static_cast<hsize_t>(range.count), width};
  const h5::Handle there = space_of(dataset);
  h5::check(H5Sselect_hyperslab(there.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
            "select rows");
  const hsize_t numbers = count[0] * count[1];
  const h5::Handle here(H5Screate_simple(1, &numbers, nullptr), H5Sclose, "make a data space");
  h5::check(H5Dread(dataset, type, here.get(), there.get(), H5P_DEFAULT, out), "read " + name);
}

}  // namespace packmpi::disk
