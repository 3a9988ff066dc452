#include "run/keeper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "base/log.hpp"
#include "base/patience.hpp"
#include "base/signals.hpp"
#include "base/text.hpp"
#include "disk/text_file.hpp"
#include "pack/checkpoint.hpp"
#include "packmpi/version.hpp"
#include "report/report.hpp"

namespace packmpi::run {
namespace {

constexpr std::int64_t look_every = 25;  // steps
constexpr double layer_interval = 60.0;  // [s] after the last one is one written at a layer's end, or so many times
constexpr double writes_apart = 20.0;    // what one takes: 5 % of the run at most, if every = "..." is longer
constexpr double never = std::numeric_limits<double>::infinity();

const char* phase_name(pack::Phase phase) {
  constexpr std::array<const char*, 3> names{"insertion", "settling", "relaxation"};
  return names.at(static_cast<std::size_t>(phase));
}

}  // namespace

Keeper::Keeper(Bed& bed, Journal& journal, const Files& files, const Options& options, const Origin& origin)
    : bed_(bed),
      journal_(journal),
      files_(files),
      stop_file_(files.stop),
      rhythm_(tables::rhythm_of(bed.scene.in.checkpoint.every).value_or(tables::Rhythm{})),
      limit_(seconds_allowed(options.max_hours)),
      last_step_(bed.progress.steps),
      step_limit_(options.max_steps > 0 ? bed.progress.steps + options.max_steps
                                        : std::numeric_limits<std::int64_t>::max()),
      serial_(origin.serial),
      slot_(origin.next_slot) {}

std::int64_t Keeper::steps_to_look() const {
  std::int64_t steps = std::min(look_every, step_limit_ - bed_.progress.steps);
  if (rhythm_.steps > 0) steps = std::min(steps, last_step_ + rhythm_.steps - bed_.progress.steps);
  return std::max<std::int64_t>(steps, 1);
}

bool Keeper::due_by_clock(double least) const {
  return rhythm_.seconds > 0.0 && watch_.seconds() - written_at_ >= std::min(rhythm_.seconds, least);
}

void Keeper::look() {
  look(due_by_clock(never) || (rhythm_.steps > 0 && bed_.progress.steps - last_step_ >= rhythm_.steps));
}

void Keeper::layer_ended() {
  look(due_by_clock(std::max(layer_interval, writes_apart * longest_write_)) || rhythm_.steps > 0);
}

void Keeper::look_while_inserting(LocalIndex before) {
  const Due due = agree(false);
  waits_ = waits_ || due.checkpoint;
  if (due.stop == Reason::none) return;
  bed_.store.keep_first(before);
  stop(due.stop);
}

// One reduction: what any rank was asked for, and what rank 0 thinks is due.
Keeper::Due Keeper::agree(bool due) {
  const double now = watch_.seconds();
  longest_gap_ = std::max(longest_gap_, now - looked_at_);
  looked_at_ = now;
  const Wish wish = take_wish();
  std::array<std::int64_t, 2> shared{wish == Wish::checkpoint ? 1 : 0,
                                     static_cast<std::int64_t>(wish == Wish::stop ? Reason::signal : Reason::none)};
  if (bed_.comm.rank() == 0) {
    if (due) shared[0] = 1;
    shared[1] = std::max(shared[1], static_cast<std::int64_t>(reason_to_stop()));
  }
  bed_.comm.max(shared);
  return {.checkpoint = shared[0] != 0, .stop = static_cast<Reason>(shared[1])};
}

void Keeper::look(bool due) {
  const Due now = agree(due || waits_);
  if (now.stop != Reason::none || now.checkpoint) bed_.check();  // nothing is written by a state that is not valid
  if (now.stop != Reason::none) stop(now.stop);
  if (!now.checkpoint) return;
  waits_ = false;
  try {
    write();
  } catch (const comm::AgreedError& error) {
    if (error.code() != ExitCode::io_failure) throw;
    keep_going_without(error.what());
  }
}

Keeper::Reason Keeper::reason_to_stop() {
  if (bed_.progress.steps >= step_limit_) return Reason::step_limit;
  if (out_of_time()) return Reason::time_limit;
  return stop_file_.is_there() ? Reason::stop_file : Reason::none;
}

// Time for the checkpoint and for another look is held back, by what they took so far.
bool Keeper::out_of_time() const { return watch_.seconds() + 2.0 * longest_write_ + 2.0 * longest_gap_ >= limit_; }

void Keeper::write() {
  const Stopwatch watch;
  journal_.sync();
  const pack::RunState state{.serial = serial_,
                             .effective_input = bed_.scene.in.effective,
                             .version = std::string(version()),
                             .git = std::string(git_id()),
                             .dimension = bed_.scene.container.dimension,
                             .rotation = bed_.scene.features.rotation,
                             .progress = bed_.progress};
  const std::array<const particles::Store*, 2> stores{&bed_.store, &bed_.neighborhood.frozen()};
  pack::write_checkpoint(bed_.comm, files_.slots[slot_], stores, state, bed_.histories());
  disk::write_text(bed_.comm, files_.manifest,
                   fmt::format("{{\"format\": \"packmpi-checkpoints\", \"format_version\": 2, \"newest\": \"{}\", "
                               "\"serial\": {}, \"layer\": {}, \"phase\": \"{}\", \"step\": {}, \"particles\": {}}}\n",
                               "AB"[slot_], serial_, bed_.progress.first_ids.size(),
                               phase_name(bed_.progress.now.phase), bed_.progress.steps, bed_.progress.count));
  const double took = bed_.comm.max(watch.seconds());
  log::debug(
      fmt::format("checkpoint {} at step {}: {}", files_.slots[slot_], bed_.progress.steps, text::duration(took)));
  ++serial_;
  slot_ = 1 - slot_;
  longest_write_ = std::max(longest_write_, took);
  written_at_ = looked_at_ = watch_.seconds();
  last_step_ = bed_.progress.steps;
  kept_ = true;
}

void Keeper::keep_going_without(const std::string& words) {
  kept_ = false;
  log::warn(
      fmt::format("no checkpoint at step {}; the last one stays, the run goes on: {}", bed_.progress.steps, words));
  written_at_ = looked_at_ = watch_.seconds();
  last_step_ = bed_.progress.steps;
}

void Keeper::stop(Reason reason) {
  if (!kept_ || last_step_ != bed_.progress.steps) write();
  constexpr std::array<const char*, 5> words{"", "a signal said so", "the STOP file is there", "the time limit is near",
                                             "--max-steps are done"};
  comm::fail_together(bed_.comm, ExitCode::stopped_early,
                      fmt::format("stopped at step {} in layer {}, with a checkpoint ({}): {}; --restart auto goes on",
                                  bed_.progress.steps, bed_.progress.first_ids.size(), files_.slots[1 - slot_],
                                  words.at(static_cast<std::size_t>(reason))));
}

void Keeper::finished() {
  comm::agree_on(bed_.comm, [&] {
    if (bed_.comm.rank() == 0) remove_checkpoints(files_);
  });
}

}  // namespace packmpi::run
