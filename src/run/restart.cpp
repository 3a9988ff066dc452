#include "run/restart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "base/log.hpp"
#include "pack/checkpoint.hpp"
#include "pack/scene_change.hpp"
#include "packmpi/version.hpp"

namespace packmpi::run {
namespace {

pack::Writer writer_of(const pack::RunState& state) { return {state.effective_input, state.version, state.git}; }

/// Throws on a scene that is not the checkpoint's. Local.
void check_scene(const pack::RunState& state, const scene::Scene& scene, const std::string& path) {
  const std::string changes =
      pack::changes_since(writer_of(state), scene.in.effective, pack::RunIs::unfinished, "checkpoint " + path);
  if (changes.empty()) return;
  throw Error(ExitCode::bad_checkpoint,
              fmt::format("checkpoint {} is of another scene: {}; undo the change, or begin anew with --force and "
                          "without --restart",
                          path, changes));
}

/// The slots whose state can be read, the newest first, as digits; why others cannot is added to `passed_over`.
std::string readable_slots(const Files& files, const scene::Scene& scene, std::string& passed_over, bool& any) {
  std::vector<std::pair<std::int64_t, std::size_t>> found;
  for (std::size_t k = 0; k < files.slots.size(); ++k) {
    if (!std::filesystem::exists(files.slots[k])) continue;
    any = true;
    try {
      found.emplace_back(pack::read_state(files.slots[k]).serial, k);
    } catch (const Error& error) {
      passed_over += fmt::format("{}{}", passed_over.empty() ? "" : "; ", error.what());
    }
  }
  std::ranges::sort(found, std::greater{});
  if (!found.empty()) {  // not passed over if it is of another scene: that is for the user to decide
    const std::string& newest = files.slots[found.front().second];
    check_scene(pack::read_state(newest), scene, newest);
  }
  std::string order;
  for (const auto& [serial, slot] : found) order += static_cast<char>('0' + slot);
  return order;
}

/// The paths to try, in order. Empty: there is nothing at all to go on from.
std::vector<std::string> choices(const comm::Comm& comm, const Files& files, const Options& options,
                                 const scene::Scene& scene, std::string& passed_over) {
  if (options.restart != "auto") {
    comm::agree_on(comm, [&] {
      if (comm.rank() == 0) check_scene(pack::read_state(options.restart), scene, options.restart);
    });
    return {options.restart};
  }
  std::string order;
  bool any = false;
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0) order = readable_slots(files, scene, passed_over, any);
  });
  order = comm.broadcast(0, order);
  passed_over = comm.broadcast(0, passed_over);
  if (order.empty() && comm.max(std::int64_t{any ? 1 : 0}) > 0) {
    comm::fail_together(comm, ExitCode::bad_checkpoint,
                        passed_over +
                            "; nothing else to go on from: begin anew with --force and "
                            "without --restart");
  }
  std::vector<std::string> paths;
  for (const char digit : order) paths.push_back(files.slots[static_cast<std::size_t>(digit - '0')]);
  return paths;
}

/// Collective.
void check_in_scene(const std::string& path, const pack::Histories& histories, const Bed& bed) {
  comm::agree_on(bed.comm, [&] {
    try {
      pack::check_in_scene(bed.store, histories, bed.scene);
    } catch (const Error& error) {
      throw Error(error.code(), fmt::format("checkpoint {}: {}", path, error.what()));
    }
  });
}

/// The first of `paths` that is valid to the last particle.
std::pair<pack::RunState, std::string> read_first(const std::vector<std::string>& paths, std::string passed_over,
                                                  Bed& bed, pack::Histories& histories) {
  for (const std::string& path : paths) {
    try {
      pack::RunState state = pack::read_checkpoint(bed.comm, path, bed.store, &histories);
      check_in_scene(path, histories, bed);
      if (!passed_over.empty()) log::warn("passed over: " + passed_over);
      return {std::move(state), path};
    } catch (const comm::AgreedError& error) {
      passed_over += fmt::format("{}{}", passed_over.empty() ? "" : "; ", error.what());
      bed.store = particles::Store(bed.store.layout());
    }
  }
  comm::fail_together(bed.comm, ExitCode::bad_checkpoint, passed_over);
}

void put_back(const pack::RunState& state, const pack::Histories& histories, Bed& bed) {
  bed.progress = state.progress;
  if (bed.box != nullptr) {
    confine::apply(bed.progress.confined, *bed.box);
    bed.ownership.stretch(*bed.box);
  }
  bed.mark_components();
  if (bed.scene.features.memory) bed.give(histories);
  bed.neighborhood.rebuild(bed.store);  // to the owners of their columns
  if (bed.progress.moving_from > 0) bed.neighborhood.freeze(bed.store, bed.progress.moving_from);
  bed.balance();
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored);
}

/// Rank-local. A number above those of all checkpoints there are.
std::int64_t next_serial(const Files& files, std::int64_t serial) {
  for (const std::string& slot : files.slots) {
    try {
      if (std::filesystem::exists(slot)) serial = std::max(serial, pack::read_state(slot).serial);
    } catch (const Error&) {
      continue;  // damaged: it will be written over
    }
  }
  return serial + 1;
}

}  // namespace

Origin resume(const Files& files, const Options& options, Bed& bed) {
  std::string passed_over;
  if (options.restart.empty()) return {};
  const std::vector<std::string> paths = choices(bed.comm, files, options, bed.scene, passed_over);
  if (paths.empty()) {
    log::info(fmt::format("no checkpoint {}: from the beginning", files.slots[0]));
    return {};
  }
  pack::Histories histories;
  const auto [state, path] = read_first(paths, passed_over, bed, histories);
  if (!pack::is_this_program(writer_of(state))) {
    log::warn(fmt::format("{} was written by packmpi {} ({}), this is {} ({}): the bits of the pack may differ", path,
                          state.version, state.git, version(), git_id()));
  }
  put_back(state, histories, bed);
  log::info(fmt::format("going on from {}: layer {}, step {}, {} particles", path, state.progress.first_ids.size(),
                        state.progress.steps, state.progress.count));
  const bool first = bed.comm.rank() == 0;
  return {.restarted = true,
          .serial = bed.comm.max(first ? next_serial(files, state.serial) : std::int64_t{0}),
          .next_slot = bed.comm.max(std::int64_t{first && same_file(path, files.slots[0])}) > 0 ? 1U : 0U};
}

}  // namespace packmpi::run
