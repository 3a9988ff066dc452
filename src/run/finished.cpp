#include "run/finished.hpp"

#include <fmt/format.h>

#include "base/log.hpp"
#include "disk/lock.hpp"
#include "pack/pack.hpp"
#include "pack/scene_change.hpp"
#include "packmpi/version.hpp"
#include "report/summary.hpp"
#include "run/analyze.hpp"
#include "run/files.hpp"

namespace packmpi::run {
namespace {

bool over(const Files& files) {
  return is_there(files.pack) && is_there(files.summary) && !is_there(files.slots[0]) && !is_there(files.slots[1]);
}

std::string refusal(const Files& files, const std::string& words) {
  return fmt::format(
      "{}; there is no checkpoint to go on from either: remove {} to have it made anew, or use --force without "
      "--restart",
      words, files.pack);
}

[[noreturn]] void refuse(const Files& files, const std::string& words) {
  throw Error(ExitCode::bad_checkpoint, refusal(files, words));
}

// The seal of a pack that is whole. Collective.
std::uint64_t whole_pack(const comm::Comm& comm, const Files& files) {
  try {
    return pack::check_pack(comm, files.pack);
  } catch (const comm::AgreedError& error) {
    comm::fail_together(comm, ExitCode::bad_checkpoint, refusal(files, error.what()));
  }
}

void check_scene(const Files& files, const scene::Scene& scene) {
  const pack::PackOrigin origin = pack::read_origin(files.pack);
  const pack::Writer writer{origin.scene, origin.version, origin.git};
  const std::string changes = pack::changes_since(writer, scene.in.effective, pack::RunIs::finished, files.pack);
  if (!changes.empty()) refuse(files, fmt::format("{} is of another scene: {}", files.pack, changes));
  if (pack::is_this_program(writer)) return;
  log::warn(fmt::format("{} was made by packmpi {} ({}), this is {} ({}), which may make other bits", files.pack,
                        writer.version, writer.git, version(), git_id()));
}

// The summary of the pack with that seal. Rank-local.
report::Summary summary_of(const Files& files, std::uint64_t seal) {
  try {
    report::Summary summary = report::read_summary(files.summary);
    if (summary.pack_seal == seal) return summary;
  } catch (const Error& error) {
    refuse(files, error.what());
  }
  refuse(files, fmt::format("{} is not the summary of {}", files.summary, files.pack));
}

std::string words_of(const Files& files, const report::Summary& summary) {
  std::string words = fmt::format("{} is finished, whole, and of this scene: {}", files.pack,
                                  summary.targets_met ? "nothing to do" : "a target was missed, nothing to do");
  if (summary.series_rows_in_file != summary.series_rows) {
    words += fmt::format("; its series has {} of {} rows", summary.series_rows_in_file, summary.series_rows);
  }
  return words;
}

// What a run that was killed in its last act has left out. Collective.
void complete_analysis(const comm::Comm& comm, const Files& files, std::uint64_t seal) {
  disk::Lock lock;
  std::int64_t missing = 0;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0 || report::pack_of_analysis(files.analysis) == seal) return;
    lock = take_lock(files.lock);
    missing = 1;
  });
  if (comm.max(missing) != 0) (void)analyze(comm, files.pack);
}

}  // namespace

std::optional<Finished> finished_run(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  const Files files = files_of(scene.in.name, options);
  std::int64_t is_over = 0;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    disk::refuse_if_locked(files.lock);
    is_over = over(files) ? 1 : 0;
  });
  if (comm.max(is_over) == 0) return {};
  const std::uint64_t seal = whole_pack(comm, files);
  std::int64_t met = 0;
  std::string words;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    check_scene(files, scene);
    const report::Summary summary = summary_of(files, seal);
    met = summary.targets_met ? 1 : 0;
    words = words_of(files, summary);
  });
  if (scene.in.output.analysis) complete_analysis(comm, files, seal);
  return Finished{comm.max(met) != 0 ? ExitCode::done : ExitCode::target_missed, comm.broadcast(0, words)};
}

}  // namespace packmpi::run
