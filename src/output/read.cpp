#include <fmt/format.h>

#include "output/pack_file.hpp"

namespace packmpi::output {

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
    const PackFile file(path);
    return file.rows(0, file.count());
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("cannot read {}: {}", path, error.what()));
  }
}

}  // namespace packmpi::output
