#include "ensemble/ensemble.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "base/log.hpp"
#include "base/signals.hpp"
#include "base/terminal.hpp"
#include "base/timer.hpp"
#include "base/voids.hpp"
#include "disk/text_file.hpp"
#include "input/read.hpp"
#include "report/ensemble.hpp"
#include "run/files.hpp"
#include "run/finished.hpp"
#include "run/make_pack.hpp"

namespace packmpi::ensemble {
namespace {

using run::Files, run::files_of, run::is_there, run::Finished, run::finished_run, run::make_pack, run::Options,
    run::take_lock;

namespace fs = std::filesystem;

constexpr std::uint64_t seeds_a_set = 10000;  // more than the packs that a set may have
constexpr std::int64_t not_made = -1;         // below all exit codes
constexpr double hardly_any = 1e-9;           // [h]

bool has_pack(std::int64_t code) {
  return code == static_cast<std::int64_t>(ExitCode::done) ||
         code == static_cast<std::int64_t>(ExitCode::target_missed);
}

constexpr std::array table_endings{".ensemble.csv", ".ensemble.json", ".ensemble.md"};

// What a user set for the whole ensemble, as far as this group of ranks has not used it up.
class Budget {
 public:
  explicit Budget(const Options& options) : hours_(options.max_hours), steps_(options.max_steps) {}

  // Collective. Nothing is left, or somebody wants the ensemble to stop.
  [[nodiscard]] bool is_over(const comm::Comm& group, const std::string& stop_file) const {
    const bool used_up = (hours_ > 0.0 && hours_left() <= 0.0) || (steps_ > 0 && steps_left() <= 0);
    const bool mine = stop_wished() || (group.rank() == 0 && (used_up || is_there(stop_file)));
    return group.max(std::int64_t{mine ? 1 : 0}) != 0;
  }
  // Of a pack that is made now.
  void limit(Options& options) const {
    if (hours_ > 0.0) options.max_hours = std::max(hours_left(), hardly_any);  // 0: no limit
    if (steps_ > 0) options.max_steps = steps_left();
  }
  void use(std::int64_t steps) { used_ += steps; }

 private:
  // Above 0, or nothing is left.
  [[nodiscard]] double hours_left() const { return hours_ - watch_.seconds() / 3600.0; }
  [[nodiscard]] std::int64_t steps_left() const { return steps_ - used_; }

  Stopwatch watch_;
  double hours_;
  std::int64_t steps_, used_ = 0;
};

// Before anything is written.
void check_free(const std::vector<Member>& all, const Files& ours, const Options& options) {
  const auto refuse = [](const std::string& words) { throw Error(ExitCode::bad_input, words); };
  if (!options.restart.empty() && options.restart != "auto") {
    refuse("an ensemble has many checkpoints; use --restart auto");
  }
  if (is_there(ours.stop)) refuse(ours.stop + " exists and would end the run at once; remove it");
  if (options.force || !options.restart.empty()) return;
  for (const Member& member : all) {
    const Files files = files_of(member.name, options);
    for (const std::string& path : {files.pack, files.summary, files.log, files.steps}) {
      if (is_there(path)) {
        refuse(path + " exists; use --force to replace it, --restart auto to go on, or -o FOLDER");
      }
    }
  }
}

// The right to write the ensemble's outputs, on rank 0. Collective.
disk::Lock claim_ensemble(const comm::Comm& world, const std::vector<Member>& all, const Files& ours,
                          const Options& options) {
  comm::agree_on(world, [&] {
    if (world.rank() != 0) return;
    disk::refuse_if_locked(ours.lock);
    check_free(all, ours, options);
  });
  disk::check_writable(world, options.folder, 0);  // each pack looks for its own room
  disk::Lock lock;
  comm::agree_on(world, [&] {
    if (world.rank() == 0) lock = take_lock(ours.lock);
  });
  return lock;
}

// Exit codes of the packs that are finished; not_made for the others. Collective. Throws on all ranks if one that is
// there is not what it should be.
std::vector<std::int64_t> take_over(const comm::Comm& world, const input::Input& in, const std::vector<Member>& all,
                                    const Options& options) {
  std::vector<std::int64_t> codes(all.size(), not_made);
  if (options.restart != "auto" || options.force) return codes;
  for (std::size_t k = 0; k < all.size(); ++k) {
    scene::Scene scene;
    comm::agree_on(world, [&] { scene = scene::build(member_input(in, all[k])); });
    const auto finished = finished_run(world, scene, options);
    if (finished) codes[k] = static_cast<std::int64_t>(finished->code);
  }
  return codes;
}

// One pack by one group of ranks; its exit code.
int make_member(const comm::Comm& group, const input::Input& in, const Member& member, Options options,
                Budget& budget) {
  options.verbosity = log::Verbosity::quiet;  // many packs at a time
  options.member = true;
  budget.limit(options);
  try {
    scene::Scene scene;
    comm::agree_on(group, [&] { scene = scene::build(member_input(in, member)); });
    const report::RunRecord record = make_pack(group, scene, options);
    budget.use(record.steps_here);
    if (group.rank() == 0) {
      print(fmt::format(
          "set {} pack {} (seed {}): {} particles, phi_bulk {:.4f}, porosity {:.4f}, void ratio {:.4f}, {:.3g} s\n",
          member.set, member.pack, member.seed, record.particles, record.phi_bulk, porosity(record.phi_bulk),
          void_ratio(record.phi_bulk), record.wall_seconds));
    }
    return static_cast<int>(record.targets_met ? ExitCode::done : ExitCode::target_missed);
  } catch (const comm::AgreedError& error) {
    const bool stopped = error.code() == ExitCode::stopped_early;
    if (group.rank() == 0 && !stopped) log::error(fmt::format("{}: {}", member.name, error.what()));
    return static_cast<int>(error.code());
  }
}

// The packs that are not made yet, by groups of ranks side by side. Collective.
void make_open(const comm::Comm& world, const input::Input& in, const std::vector<Member>& all, const Options& options,
               std::vector<std::int64_t>& codes) {
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (codes[k] == not_made) open.push_back(k);
  }
  const auto groups = static_cast<int>(std::min<std::size_t>(open.size(), static_cast<std::size_t>(world.size())));
  const int mine = static_cast<int>(std::int64_t{world.rank()} * groups / world.size());
  const comm::Comm group = world.split(mine);
  const std::string stop_file = files_of(in.name, options).stop;
  const Signals signals;
  Budget budget(options);
  bool stopped = false;
  for (std::size_t k = static_cast<std::size_t>(mine); k < open.size(); k += static_cast<std::size_t>(groups)) {
    stopped = stopped || budget.is_over(group, stop_file);
    const int code =
        stopped ? static_cast<int>(ExitCode::stopped_early) : make_member(group, in, all[open[k]], options, budget);
    stopped = stopped || code == static_cast<int>(ExitCode::stopped_early);
    codes[open[k]] = code;
  }
  world.max(std::span(codes));
  log::start(world.rank(), std::nullopt, options.verbosity);
}

// The gravest: a fault is worse than a missed target.
int worst(const std::vector<std::int64_t>& codes) {
  for (const ExitCode code : {ExitCode::stopped_early, ExitCode::numerical_failure, ExitCode::io_failure,
                              ExitCode::bad_checkpoint, ExitCode::bad_input, ExitCode::target_missed}) {
    if (std::ranges::find(codes, static_cast<std::int64_t>(code)) != codes.end()) return static_cast<int>(code);
  }
  return static_cast<int>(ExitCode::done);
}

// The last of them, for people. Collective.
std::string write_tables(const comm::Comm& world, const input::Input& in, const std::vector<Member>& all,
                         const std::vector<std::int64_t>& codes, const Options& options) {
  report::EnsembleTable table{.name = in.name, .packs = {}};
  comm::agree_on(world, [&] {
    if (world.rank() != 0) return;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::string summary = files_of(all[k].name, options).summary;
      table.packs.push_back(report::ensemble_row(all[k].set, all[k].pack, all[k].seed, static_cast<int>(codes[k]),
                                                 has_pack(codes[k]) ? summary : ""));
    }
  });
  const std::array texts{report::to_csv(table), report::to_json(table), report::to_markdown(table)};
  for (std::size_t k = 0; k < texts.size(); ++k) {
    disk::write_text(world, (fs::path(options.folder) / (in.name + table_endings[k])).string(), texts[k]);
  }
  return texts.back();
}

// Tables of fewer packs than there are going to be.
void remove_tables(const comm::Comm& world, const input::Input& in, const Options& options) {
  if (world.rank() != 0) return;
  std::error_code ignored;
  for (const char* ending : table_endings) fs::remove(fs::path(options.folder) / (in.name + ending), ignored);
}

}  // namespace

std::vector<Member> members(const input::Input& in) {
  const auto sets = static_cast<std::uint64_t>(in.ensemble.sets), packs = static_cast<std::uint64_t>(in.ensemble.packs);
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const std::uint64_t last = seeds_a_set * (sets - 1) + packs - 1;
  if (in.seed > most - last) {
    throw Error(ExitCode::bad_input,
                fmt::format("{}: seed: {} sets of {} packs from seed {} on go beyond 2^63 - 1; use a smaller one",
                            in.file, sets, packs, in.seed));
  }
  std::vector<Member> all;
  for (int set = 1; set <= in.ensemble.sets; ++set) {
    for (int pack = 1; pack <= in.ensemble.packs; ++pack) {
      const auto before = static_cast<std::uint64_t>(set - 1) * seeds_a_set + static_cast<std::uint64_t>(pack - 1);
      all.push_back({set, pack, in.seed + before, fmt::format("{}_{}_{}", in.name, set, pack)});
    }
  }
  return all;
}

input::Input member_input(const input::Input& in, const Member& member) {
  input::Input mine = input::parse(in.effective, in.file,
                                   {{fmt::format("seed={}", member.seed), "ensemble.sets=1", "ensemble.packs=1"}});
  mine.name = member.name;
  return mine;
}

int make_ensemble(const comm::Comm& world, const input::Input& in, const Options& options) {
  std::vector<Member> all;
  comm::agree_on(world, [&] { all = members(in); });
  const disk::Lock lock = claim_ensemble(world, all, files_of(in.name, options), options);
  std::vector<std::int64_t> codes = take_over(world, in, all, options);
  const bool was_over = std::ranges::find(codes, not_made) == codes.end();
  if (!was_over) {
    remove_tables(world, in, options);
    make_open(world, in, all, options, codes);
  }
  const int code = worst(codes);
  if (code == static_cast<int>(ExitCode::stopped_early)) {
    comm::fail_together(
        world, ExitCode::stopped_early,
        fmt::format("stopped early, with {} of {} packs made and no tables yet; --restart auto goes on with "
                    "those that are left",
                    std::ranges::count_if(codes, has_pack), all.size()));
  }
  const std::string table = write_tables(world, in, all, codes, options);
  if (world.rank() == 0) {
    print(was_over ? fmt::format("all {} packs of {} are finished, whole, and of this scene: nothing to do\n",
                                 all.size(), in.name)
                   : "\n" + table);
  }
  return code;
}

}  // namespace packmpi::ensemble
