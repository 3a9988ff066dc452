#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "base/regular_file.hpp"
#include "disk/files.hpp"
#include "report/report.hpp"

namespace packmpi::report {
namespace {

/// The whole lines of a series up to and with step `last`; "" if there is none.
std::string rows_until(const std::string& path, std::int64_t last) {
  if (!RegularFile(path).flaw().empty()) return "";
  std::ifstream file(path);
  std::string kept;
  for (std::string line; std::getline(file, line) && !file.eof();) {  // eof: the line was cut off
    if (!kept.empty()) {
      const std::size_t comma = line.find(',');
      std::int64_t step = -1;
      if (comma != std::string::npos) std::from_chars(line.data() + comma + 1, line.data() + line.size(), step);
      if (step < 0 || step > last) break;
    }
    kept += line + "\n";
  }
  return kept;
}

}  // namespace

StepLog::StepLog(const comm::Comm& comm, const std::string& path, std::optional<std::int64_t> last_step)
    : comm_(&comm), path_(path) {
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    const std::string kept = last_step ? rows_until(path, *last_step) : "";
    if (kept.empty()) {
      disk::Descriptor::create(path).close();  // never through a link
    } else {
      disk::write_whole(path, kept);
    }
    file_.open(path, std::ios::app);
    if (!file_) disk::fail(path, "open", errno);
    if (!kept.empty()) return;
    file_ << "layer,step,time [s],particles,kinetic energy [J],max speed [m/s],top [m],mean height [m],max force "
             "[N],rebuilds,moving,rotational energy [J],potential energy [J],elastic energy [J],dissipated "
             "[J],momentum x "
             "[kg m/s],momentum y [kg m/s],momentum z [kg m/s]\n";
    flush();
  });
}

void StepLog::append(const StepRow& row) {
  if (comm_->rank() != 0 || failure_ != 0) return;
  file_ << fmt::format(
      "{},{},{:.9g},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n",
      row.layer, row.step, row.time, row.particles, row.kinetic_energy, row.max_speed, row.top, row.mean_height,
      row.max_force, row.rebuilds, row.moving, row.rotational_energy, row.potential_energy, row.elastic_energy,
      row.dissipated, row.momentum[0], row.momentum[1], row.momentum[2]);
  flush();
}

void StepLog::flush() {
  errno = 0;
  file_.flush();
  if (!file_ && failure_ == 0) failure_ = errno != 0 ? errno : EIO;
}

void StepLog::close() {
  comm::agree_on(*comm_, [&] {
    if (comm_->rank() != 0 || !file_.is_open()) return;
    flush();
    errno = 0;
    file_.close();
    if (!file_ && failure_ == 0) failure_ = errno != 0 ? errno : EIO;
    if (failure_ != 0) disk::fail(path_, "write", failure_);
  });
}

}  // namespace packmpi::report
