#include "disk/whole_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

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

/// This rank's rows on their way to the disk.
class RowWriter {
 public:
  RowWriter(const std::string& path, const std::vector<h5::Column>& plan, const std::vector<std::int64_t>& places)
      : disk_(path, O_WRONLY), plan_(&plan), places_(&places), written_(plan.size()), digests_(plan.size()) {}

  /// The rows at hand, a few of all columns at a time: they are parts of the same records, which are then still in the
  /// cache.
  void write() {
    constexpr std::size_t at_a_time = 4096;
    std::size_t most = 0;
    for (std::size_t k = 0; k < plan_->size(); ++k) {
      most = std::max(most, at_hand(k));
      if (written_[k] + at_hand(k) > (*plan_)[k].slab.count) fail_count(k, "more");
    }
    for (std::size_t first = 0; first < most; first += at_a_time) {
      for (std::size_t k = 0; k < plan_->size(); ++k) write_some(k, first, at_a_time);
    }
    for (std::size_t k = 0; k < plan_->size(); ++k) written_[k] += at_hand(k);
  }

  /// Down to the disk. The digests of the rows, a column each.
  [[nodiscard]] std::vector<std::int64_t> finish() {
    for (std::size_t k = 0; k < plan_->size(); ++k) {
      if (written_[k] != (*plan_)[k].slab.count) fail_count(k, "fewer");
    }
    disk_.sync();
    disk_.close();
    return {digests_.begin(), digests_.end()};
  }

 private:
  /// None of a column that is complete: it had them all with an earlier piece.
  [[nodiscard]] std::size_t at_hand(std::size_t k) const {
    return written_[k] == (*plan_)[k].slab.count ? 0 : (*plan_)[k].held();
  }

  /// Of column k the rows at hand [first, first + most), or those of them there are.
  void write_some(std::size_t k, std::size_t first, std::size_t most) {
    const h5::Column& column = (*plan_)[k];
    const std::size_t held = at_hand(k);
    if (first >= held) return;
    const std::size_t each = h5::row_bytes(column);
    const std::size_t row = written_[k] + first;
    const std::vector<std::byte> bytes = column.bytes(first, std::min(most, held - first));
    disk_.write_at(bytes, h5::place_of_rows(column, (*places_)[k]) + static_cast<std::int64_t>(row * each));
    digests_[k] += rows_digest(bytes, each, static_cast<std::int64_t>(column.slab.offset + row));
  }

  [[noreturn]] void fail_count(std::size_t k, std::string_view what) const {
    throw Error(ExitCode::numerical_failure,
                fmt::format("{} rows came for {} than were counted", what, (*plan_)[k].path));
  }

  Descriptor disk_;
  const std::vector<h5::Column>* plan_;
  const std::vector<std::int64_t>* places_;
  std::vector<std::size_t> written_;    // rows of each column
  std::vector<std::uint64_t> digests_;  // these sums wrap
};

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
                     const std::function<void(hid_t)>& frame, const Pieces& pieces) {
  Seal seal;
  together(comm, path, [&] {
    if (comm.rank() == 0) seal = make_frame(path, plan, frame);
  });
  const std::vector<std::int64_t> places = share_places(comm, seal, plan.size());
  std::optional<RowWriter> rows;
  together(comm, path, [&] { rows.emplace(path, plan, places); });
  for (std::int64_t piece = 0; piece < pieces.count; ++piece) {
    pieces.bring(piece);
    together(comm, path, [&] { rows->write(); });
  }
  std::vector<std::int64_t> digests(plan.size());
  together(comm, path, [&] { digests = rows->finish(); });
  comm.sum(std::span(digests));
  together(comm, path, [&] {
    if (comm.rank() == 0) write_seal(path, seal, digests);
  });
}

}  // namespace

h5::Slab slab_of(const comm::Comm& comm, std::int64_t mine) {
  return {static_cast<hsize_t>(comm.sum(mine)), static_cast<hsize_t>(comm.sum_below(mine)), static_cast<hsize_t>(mine)};
}

void write_whole_file(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                      const std::function<void(hid_t)>& frame, const Pieces& pieces) {
  const h5::Quiet quiet;
  const std::string temporary = path + ".tmp";
  try {
    write_temporary(comm, temporary, plan, frame, pieces);
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
