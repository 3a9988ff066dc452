#include "report/step_log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include "base/digest.hpp"
#include "base/log.hpp"
#include "base/regular_file.hpp"

namespace packmpi::report {
namespace {

constexpr std::string_view header =
    "layer,step,time [s],particles,kinetic energy [J],max speed [m/s],top [m],mean height [m],max force "
    "[N],rebuilds,moving,rotational energy [J],potential energy [J],elastic energy [J],dissipated [J],momentum x "
    "[kg m/s],momentum y [kg m/s],momentum z [kg m/s]\n";
constexpr int rebuilds_column = 9;                           // from 0
constexpr std::size_t most_waiting = std::size_t{64} << 20;  // bytes of rows that wait for room on the disk

std::string text_of(const StepRow& row) {
  return fmt::format(
      "{},{},{:.9g},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n",
      row.layer, row.step, row.time, row.particles, row.kinetic_energy, row.max_speed, row.top, row.mean_height,
      row.max_force, row.rebuilds, row.moving, row.rotational_energy, row.potential_energy, row.elastic_energy,
      row.dissipated, row.momentum[0], row.momentum[1], row.momentum[2]);
}

// The digest goes on with a row, but for its number of rebuilds.
std::uint64_t add_row(std::uint64_t digest, std::string_view row) {
  std::size_t begin = 0;
  for (int column = 0; column < rebuilds_column && begin != std::string_view::npos; ++column) {
    begin = row.find(',', begin + (column > 0 ? 1 : 0));
  }
  if (begin == std::string_view::npos) return fnv_add(digest, row);
  return fnv_add(fnv_add(digest, row.substr(0, begin)), row.substr(std::min(row.find(',', begin + 1), row.size())));
}

// Bytes of the file that are the header and the rows of `mark`; none if it does not begin with them, or if it is not
// known which they are (-1, a checkpoint of format version 2).
std::optional<std::int64_t> bytes_of(const std::string& path, const SeriesMark& mark) {
  if (!RegularFile(path).flaw().empty()) return {};
  std::ifstream file(path);
  std::string line;
  const auto next = [&] {
    const bool whole = std::getline(file, line) && !file.eof();  // eof: the line was cut off
    line += '\n';
    return whole;
  };
  if (mark.in_file < 0 || !next() || line != header) return {};
  auto bytes = static_cast<std::int64_t>(header.size());
  std::uint64_t digest = fnv_start;
  for (std::int64_t row = 0; row < mark.in_file; ++row) {
    if (!next()) return {};
    digest = add_row(digest, line);
    bytes += static_cast<std::int64_t>(line.size());
  }
  return digest == mark.digest ? std::optional(bytes) : std::nullopt;
}

}  // namespace

StepLog::StepLog(const comm::Comm& comm, const std::string& path, SeriesMark& mark, bool goes_on)
    : comm_(&comm), path_(path), mark_(mark) {
  std::int64_t anew = 1;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0 || (goes_on && go_on())) {
      anew = 0;
    } else {
      begin();
    }
  });
  if (comm.max(anew) != 0) mark_ = {.rows = goes_on ? mark.rows : 0};
}

void StepLog::begin() {
  disk::write_whole(path_, header);
  file_ = std::make_unique<disk::Descriptor>(path_, O_WRONLY);
  end_ = static_cast<std::int64_t>(header.size());
}

// False if the file is not what it should be: then it is out of the way.
bool StepLog::go_on() {
  if (const auto bytes = bytes_of(path_, mark_)) {
    file_ = std::make_unique<disk::Descriptor>(path_, O_WRONLY);
    end_ = *bytes;
    if (ftruncate(file_->get(), end_) != 0) disk::fail(path_, "truncate", errno);
    return true;
  }
  std::error_code code;
  const bool there = std::filesystem::exists(path_, code);
  if (there) std::filesystem::rename(path_, path_ + ".old", code);
  if (there && code) disk::fail(path_, "rename it to .old", code.value());
  log::warn(fmt::format("{} {}: {} rows of this run are not in it; a new series begins here", path_,
                        there ? "is not the series up to the checkpoint, and is now " + path_ + ".old" : "is missing",
                        mark_.rows));
  return false;
}

void StepLog::append(const StepRow& row) {
  const std::string text = text_of(row);
  ++mark_.rows;
  ++mark_.in_file;
  mark_.digest = add_row(mark_.digest, text);
  if (comm_->rank() != 0) return;
  if (waiting_.size() + text.size() > most_waiting) {
    ++lost_;
  } else {
    waiting_ += text;
  }
  flush();
}

// What a failed write has left behind the whole rows is written over by the next.
void StepLog::flush() {
  if (waiting_.empty()) return;
  try {
    file_->write_at(std::as_bytes(std::span(waiting_)), end_);
  } catch (const Error& error) {
    if (!warned_) log::warn(fmt::format("{}; its rows wait in memory until they can be written", error.what()));
    warned_ = true;
    return;
  }
  end_ += static_cast<std::int64_t>(waiting_.size());
  waiting_.clear();
  if (warned_) log::info(fmt::format("{}: the rows that waited are written", path_));
  warned_ = false;
}

void StepLog::sync() {
  if (file_ == nullptr) return;
  flush();
  try {
    file_->sync();
    safe_ = mark_.in_file - lost_ - std::ranges::count(waiting_, '\n');
  } catch (const Error& error) {
    log::warn(error.what());
  }
}

std::int64_t StepLog::close() {
  sync();
  file_.reset();
  return comm_->max(safe_);
}

}  // namespace packmpi::report
