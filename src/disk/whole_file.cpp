#include "disk/whole_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <span>

#include "disk/files.hpp"
#include "disk/seal.hpp"

namespace packmpi::disk {
namespace {

constexpr std::int64_t frame_bytes = std::int64_t{1} << 20;  // more than attributes and small tables take

std::int64_t bytes_of_rows(const std::vector<h5::Column>& plan) {
  std::int64_t bytes = 0;
  for (const h5::Column& column : plan) bytes += static_cast<std::int64_t>(column.slab.total * h5::row_bytes(column));
  return bytes;
}

/// Runs `step`, agreed by all; words that do not say where are given the path.
template <class Step>
void together(const comm::Comm& comm, const std::string& path, Step&& step) {
  comm::agree_on(comm, [&] {
    try {
      step();
    } catch (const Error& error) {
      const std::string words = error.what();
      if (words.find(path) != std::string::npos) throw;
      throw Error(error.code(), fmt::format("cannot write {}: {}", path, words));
    }
  });
}

/// On rank 0: the file with everything but the rows, and the disk space for them. HDF5 makes it in memory, where the
/// rows are a hole. The seal as far as known: without the digests of the rows.
Seal make_frame(const std::string& path, const std::vector<h5::Column>& plan, const std::function<void(hid_t)>& frame) {
  reserve(path, bytes_of_rows(plan));
  const MemoryFile memory(path);
  memory.expect(bytes_of_rows(plan) + frame_bytes, path);
  h5::Handle file = h5::create_file(path, memory);
  frame(file.get());
  Seal seal;
  for (const h5::Column& column : plan) {
    seal.columns.push_back({.place = h5::place_of(file.get(), column),
                            .rows = static_cast<std::int64_t>(column.slab.total),
                            .row_bytes = static_cast<std::int64_t>(h5::row_bytes(column))});
  }
  file.close("close the file");
  seal.end = memory.size();
  seal.frame = frame_digest(seal, [&](std::int64_t begin, std::int64_t size) { return memory.read(begin, size); });
  Descriptor disk(path, O_WRONLY);
  memory.copy_to(disk);
  disk.close();
  return seal;
}

/// This rank's rows [first, first + most) of a column, or those of them there are. Their digest.
std::uint64_t write_some(Descriptor& disk, const h5::Column& column, std::int64_t place, std::size_t first,
                         std::size_t most) {
  if (first >= column.slab.count) return 0;
  const std::size_t each = h5::row_bytes(column);
  const std::vector<std::byte> bytes = column.bytes(first, std::min<std::size_t>(most, column.slab.count - first));
  disk.write_at(bytes, h5::place_of_rows(column, place) + static_cast<std::int64_t>(first * each));
  return rows_digest(bytes, each, static_cast<std::int64_t>(column.slab.offset + first));
}

/// This rank's rows, down to the disk, a few of all columns at a time: they are parts of the same records, which are
/// then still in the cache. Their digests, a column each.
std::vector<std::int64_t> write_rows(const std::string& path, const std::vector<h5::Column>& plan,
                                     const std::vector<std::int64_t>& places) {
  constexpr std::size_t at_a_time = 4096;
  std::vector<std::uint64_t> digests(plan.size());  // these sums wrap
  Descriptor disk(path, O_WRONLY);
  std::size_t most = 0;
  for (const h5::Column& column : plan) most = std::max<std::size_t>(most, column.slab.count);
  for (std::size_t first = 0; first < most; first += at_a_time) {
    for (std::size_t k = 0; k < plan.size(); ++k) {
      digests[k] += write_some(disk, plan[k], places[k], first, at_a_time);
    }
  }
  disk.sync();
  disk.close();
  return {digests.begin(), digests.end()};
}

/// The places of all columns' rows, on every rank.
std::vector<std::int64_t> share_places(const comm::Comm& comm, const Seal& seal, std::size_t columns) {
  std::vector<std::int64_t> places(columns);
  if (comm.rank() == 0) {
    for (std::size_t k = 0; k < columns; ++k) places[k] = seal.columns[k].place;
  }
  comm.max(std::span(places));
  return places;
}

void write_seal(const std::string& path, Seal seal, const std::vector<std::int64_t>& digests) {
  for (std::size_t k = 0; k < digests.size(); ++k) seal.columns[k].digest = static_cast<std::uint64_t>(digests[k]);
  const std::string bytes = to_bytes(seal);
  Descriptor disk(path, O_WRONLY);
  disk.write_at(std::as_bytes(std::span(bytes)), seal.end);
  disk.close();
}

/// The file under its temporary name.
void write_temporary(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                     const std::function<void(hid_t)>& frame) {
  Seal seal;
  together(comm, path, [&] {
    if (comm.rank() == 0) seal = make_frame(path, plan, frame);
  });
  const std::vector<std::int64_t> places = share_places(comm, seal, plan.size());
  std::vector<std::int64_t> digests(plan.size());
  together(comm, path, [&] { digests = write_rows(path, plan, places); });
  comm.sum(std::span(digests));
  together(comm, path, [&] {
    if (comm.rank() == 0) write_seal(path, seal, digests);
  });
}

}  // namespace

void write_whole_file(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                      const std::function<void(hid_t)>& frame) {
  const h5::Quiet quiet;
  const std::string temporary = path + ".tmp";
  try {
    write_temporary(comm, temporary, plan, frame);
    together(comm, path, [&] {
      if (comm.rank() == 0) commit(temporary, path);
    });
  } catch (const comm::AgreedError&) {  // every rank is here, and has let go of the file
    if (comm.rank() == 0) discard(temporary);
    throw;
  }
}

std::int64_t whole_file_bytes(const std::vector<h5::Column>& plan, const std::function<void(hid_t)>& frame) {
  const h5::Quiet quiet;
  std::error_code ignored;
  std::string name = (std::filesystem::temp_directory_path(ignored) / "packmpi-XXXXXX").string();
  const int taken = mkstemp(name.data());  // HDF5 wants a file that nobody else has locked
  if (taken < 0) fail(name, "take a name", errno);
  ::close(taken);
  const MemoryFile memory(name);
  h5::Handle file;
  try {
    file = h5::create_file(name, memory);
  } catch (...) {
    discard(name);
    throw;
  }
  discard(name);
  frame(file.get());
  file.close("close the file");
  const Seal seal{std::vector<SealedRows>(plan.size())};
  return memory.size() + static_cast<std::int64_t>(to_bytes(seal).size());
}

}  // namespace packmpi::disk
