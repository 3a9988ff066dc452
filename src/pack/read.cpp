#include <fmt/format.h>

#include "base/regular_file.hpp"
#include "disk/scatter.hpp"
#include "disk/seal.hpp"
#include "pack/pack_file.hpp"

namespace packmpi::pack {
namespace {

/// Whether the beginning of a damaged file names this format and not the other.
bool looks_like_pack(const std::string& path) {
  constexpr std::int64_t look = 65536;
  const RegularFile file(path);
  const std::string begin = file.flaw().empty() ? file.read(0, look).value_or("") : "";
  return begin.find("packmpi-pack") != std::string::npos && begin.find("packmpi-checkpoint") == std::string::npos;
}

}  // namespace

bool is_pack(const std::string& path) {
  const disk::h5::Quiet quiet;
  try {
    return disk::SealedFile(path).has("/summary");
  } catch (const Error&) {  // nothing for HDF5 to read
    return looks_like_pack(path);
  }
}

namespace {

// The path belongs to every complaint.
template <class Read>
auto told(const std::string& path, Read&& read) {
  try {
    return read();
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("cannot read {}: {}", path, error.what()));
  }
}

template <class Read>
auto read_from(const std::string& path, Read&& read) {
  const disk::h5::Quiet quiet;
  return told(path, [&] { return read(PackFile(path)); });
}

}  // namespace

PackRows read_pack(const std::string& path) {
  return read_from(path, [&](const PackFile& file) {
    disk::check_rows(file.seal(), disk::row_digests(path, file.seal(), 0, 1));
    return file.rows(0, file.count());
  });
}

std::uint64_t check_pack(const comm::Comm& comm, const std::string& path) {
  std::vector<std::int64_t> digests;
  disk::Seal seal;
  comm::agree_on(comm, [&] {
    seal = told(path, [&] { return disk::check_frame(path); });
    digests = told(path, [&] { return disk::row_digests(path, seal, comm.rank(), comm.size()); });
  });
  comm.sum(std::span(digests));
  comm::agree_on(comm, [&] { told(path, [&] { disk::check_rows(seal, digests); }); });
  return disk::digest_of(seal);
}

std::uint64_t seal_of(const std::string& path) {
  return told(path, [&] { return disk::digest_of(disk::check_frame(path)); });
}

PackOrigin read_origin(const std::string& path) {
  return read_from(path, [](const PackFile& file) {
    return PackOrigin{file.scene(), file.text("/provenance", "version"), file.text("/provenance", "git"),
                      file.number("/summary", "phi_bulk")};
  });
}

PackSlice read_slice(const std::string& path, Rank rank, int ranks) {
  return read_from(path, [&](const PackFile& file) {
    const disk::IdBlocks share{file.count(), ranks};
    const std::int64_t begin = share.begin(rank);
    return PackSlice{file.rows(begin, share.begin(rank + 1) - begin), file.scene(), file.confined()};
  });
}

}  // namespace packmpi::pack
