// Runs in memory or with files, and ensembles: include/packmpi/run.hpp.
#include "packmpi/run.hpp"

#include <fmt/core.h>

#include <exception>

#include "base/log.hpp"
#include "base/memory.hpp"
#include "comm/petsc.hpp"
#include "ensemble/ensemble.hpp"
#include "forecast/estimate.hpp"
#include "input/input.hpp"
#include "library/failure.hpp"
#include "library/rows.hpp"
#include "run/make_pack.hpp"
#include "start/fit.hpp"

namespace packmpi {
namespace {

/// Tells the caller how far a run is, and takes the pack at its end.
class Guest final : public run::Attendant {
 public:
  Guest(const comm::Comm& comm, const std::function<void(const Progress&)>& told)
      : comm_(comm), told_(told), anyone_(comm.max(std::int64_t{told ? 1 : 0}) > 0) {}

  void layer_inserted(const report::LayerRow& row) override {
    ++now_.layer;
    now_.particles = row.total;
    tell("inserting", 1.0);
  }
  void moment(double share) override { tell(relaxing_ ? "relaxing" : "settling", share); }
  void layer_settled(const report::LayerRow& row) override { now_.height = row.height; }
  void relaxation_started() override { relaxing_ = true; }
  void measured(const run::Bed& bed, const report::RunRecord& record) override {
    rows_ = library::rows_of(bed, record);
  }

  [[nodiscard]] const std::exception_ptr& thrown() const noexcept { return thrown_; }
  [[nodiscard]] Packing take() { return Packing(std::move(rows_)); }

 private:
  // Whoever listens may end the run, and does so on all ranks.
  void tell(const char* stage, double share) {
    if (!anyone_) return;
    now_.stage = stage;
    now_.share = share;
    try {
      if (told_) told_(now_);
    } catch (...) {
      thrown_ = std::current_exception();
    }
    if (comm_.max(std::int64_t{thrown_ ? 1 : 0}) > 0) {
      comm::fail_together(comm_, ExitCode::stopped_early, "ended by what was called for its progress; no checkpoint");
    }
  }

  const comm::Comm& comm_;
  const std::function<void(const Progress&)>& told_;
  bool anyone_;
  bool relaxing_ = false;
  Progress now_;
  std::exception_ptr thrown_;
  std::shared_ptr<const Packing::Rows> rows_;
};

run::Options run_options_of(const Scene& scene, const RunOptions& options) {
  run::Options out;
  out.scene = scene.file();
  out.folder = options.folder.empty() ? "." : options.folder;
  out.force = options.force;
  out.restart = options.restart;
  out.max_hours = options.max_hours;
  out.verbosity = log::Verbosity::quiet;
  return out;
}

void refuse_several(const Scene& scene) {
  if (scene.packs() == 1) return;
  throw Error(ExitCode::bad_input,
              fmt::format("{}: ensemble: {} packs, and make_packing() makes one; call make_ensemble()", scene.file(),
                          scene.packs()));
}

void make_here(const comm::Comm& comm, const Scene& what, const RunOptions& options, Guest& guest) {
  const input::Input in = start::with_start(comm, what.input());
  refuse_several(what);
  comm::petsc_options(in.petsc.options);
  const scene::Scene scene = scene::build(in);
  expect_memory(forecast::memory_a_rank(scene, comm.size()));
  log::start(comm.rank(), std::nullopt, log::Verbosity::quiet);
  if (options.folder.empty()) {
    (void)run::make_in_memory(comm, scene, guest);
  } else {
    (void)run::make_pack(comm, scene, run_options_of(what, options), &guest);
  }
}

}  // namespace

Packing make_packing(const Scene& scene, MPI_Comm world, const RunOptions& options) {
  const comm::Comm comm(world);
  Guest guest(comm, options.progress);
  const comm::Failure failure = comm::end_together(comm, [&] { make_here(comm, scene, options, guest); });
  log::finish();
  if (guest.thrown()) std::rethrow_exception(guest.thrown());
  if (failure.code != ExitCode::done) throw library::failure_of(failure, scene.file());
  return guest.take();
}

int make_ensemble(const Scene& scene, MPI_Comm world, const RunOptions& options) {
  const comm::Comm comm(world);
  int code = 0;
  const comm::Failure failure = comm::end_together(comm, [&] {
    const input::Input in = start::with_start(comm, scene.input());
    comm::petsc_options(in.petsc.options);
    log::start(comm.rank(), std::nullopt, log::Verbosity::quiet);
    code = ensemble::make_ensemble(comm, in, run_options_of(scene, options));
  });
  log::finish();
  if (failure.code != ExitCode::done) throw library::failure_of(failure, scene.file());
  return code;
}

}  // namespace packmpi
