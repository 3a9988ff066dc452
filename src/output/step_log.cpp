#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "output/files.hpp"
#include "output/report.hpp"

namespace packmpi::output {

StepLog::StepLog(const comm::Comm& comm, const std::string& path) : comm_(&comm), path_(path) {
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    file_.open(path, std::ios::trunc);
    if (!file_) fail(path, "open", errno);
    file_ << "layer,step,time [s],particles,kinetic energy [J],max speed [m/s],top [m],mean height [m],max force "
             "[N],rebuilds,moving\n";
    flush();
  });
}

void StepLog::append(const StepRow& row) {
  if (comm_->rank() != 0 || failure_ != 0) return;
  file_ << fmt::format("{},{},{:.9g},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{}\n", row.layer, row.step, row.time,
                       row.particles, row.kinetic_energy, row.max_speed, row.top, row.mean_height, row.max_force,
                       row.rebuilds, row.moving);
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
    if (failure_ != 0) fail(path_, "write", failure_);
  });
}

}  // namespace packmpi::output
