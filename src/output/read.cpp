#include <fmt/format.h>

#include "output/pack_file.hpp"
#include "output/scatter.hpp"

namespace packmpi::output {

bool is_pack(const std::string& path) {
  const h5::Quiet quiet;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) return false;
  const bool pack = H5Lexists(file, "/summary", H5P_DEFAULT) > 0;
  H5Fclose(file);
  return pack;
}

namespace {

// The path belongs to every complaint.
template <class Read>
auto read_from(const std::string& path, Read&& read) {
  const h5::Quiet quiet;
  try {
    return read(PackFile(path));
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("cannot read {}: {}", path, error.what()));
  }
}

}  // namespace

PackRows read_pack(const std::string& path) {
  return read_from(path, [](const PackFile& file) { return file.rows(0, file.count()); });
}

PackSlice read_slice(const std::string& path, Rank rank, int ranks) {
  return read_from(path, [&](const PackFile& file) {
    const IdBlocks share{file.count(), ranks};
    const std::int64_t begin = share.begin(rank);
    return PackSlice{file.rows(begin, share.begin(rank + 1) - begin), file.text("/provenance", "effective_input")};
  });
}

}  // namespace packmpi::output
