#include "run/ensemble.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "base/log.hpp"
#include "base/terminal.hpp"
#include "disk/text_file.hpp"
#include "input/read.hpp"
#include "report/ensemble.hpp"
#include "report/report.hpp"
#include "run/make_pack.hpp"
#include "run/signals.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

std::string path_of(const Options& options, const std::string& name, const char* ending) {
  return (fs::path(options.folder) / (name + ending)).string();
}

bool is_there(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// What is on the disk when a member is done.
bool finished(const Options& options, const Member& member) {
  return is_there(path_of(options, member.name, ".hdf")) && is_there(path_of(options, member.name, ".json")) &&
         !is_there(path_of(options, member.name, ".ckpt.A.hdf")) &&
         !is_there(path_of(options, member.name, ".ckpt.B.hdf"));
}

// Before anything is written.
void check_free(const std::vector<Member>& all, const Options& options) {
  if (!options.restart.empty() && options.restart != "auto") {
    throw Error(ExitCode::bad_input, "an ensemble has many checkpoints; use --restart auto");
  }
  if (options.force || !options.restart.empty()) return;
  for (const Member& member : all) {
    for (const char* ending : {".hdf", ".json", ".log", ".steps.csv"}) {
      const std::string path = path_of(options, member.name, ending);
      if (is_there(path)) {
        throw Error(ExitCode::bad_input,
                    path + " exists; use --force to replace it, --restart auto to go on, or -o FOLDER");
      }
    }
  }
}

// One pack by one group of ranks; its exit code.
int make_member(const comm::Comm& group, const input::Input& in, const Member& member, Options options) {
  options.verbosity = log::Verbosity::quiet;  // many packs at a time
  try {
    scene::Scene scene;
    comm::agree_on(group, [&] { scene = scene::build(member_input(in, member)); });
    const report::RunRecord record = make_pack(group, scene, options);
    if (group.rank() == 0) {
      print(fmt::format("set {} pack {} (seed {}): {} particles, phi_bulk {:.4f}, {:.3g} s\n", member.set, member.pack,
                        member.seed, record.particles, record.phi_bulk, record.wall_seconds));
    }
    return static_cast<int>(targets_met(record) ? ExitCode::done : ExitCode::target_missed);
  } catch (const comm::AgreedError& error) {
    const bool stopped = error.code() == ExitCode::stopped_early;
    if (group.rank() == 0 && !stopped) log::error(fmt::format("{}: {}", member.name, error.what()));
    return static_cast<int>(error.code());
  }
}

// The gravest: a fault is worse than a missed target.
int worst(const std::vector<std::int64_t>& codes) {
  for (const ExitCode code : {ExitCode::stopped_early, ExitCode::numerical_failure, ExitCode::io_failure,
                              ExitCode::bad_checkpoint, ExitCode::bad_input, ExitCode::target_missed}) {
    if (std::ranges::find(codes, static_cast<std::int64_t>(code)) != codes.end()) return static_cast<int>(code);
  }
  return static_cast<int>(ExitCode::done);
}

void write_tables(const comm::Comm& world, const input::Input& in, const std::vector<Member>& all,
                  const std::vector<std::int64_t>& codes, const Options& options) {
  report::EnsembleTable table{.name = in.name, .packs = {}};
  comm::agree_on(world, [&] {
    if (world.rank() != 0) return;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::string summary = path_of(options, all[k].name, ".json");
      const bool done = codes[k] == 0 || codes[k] == static_cast<std::int64_t>(ExitCode::target_missed);
      table.packs.push_back(
          report::ensemble_row(all[k].set, all[k].pack, all[k].seed, static_cast<int>(codes[k]), done ? summary : ""));
    }
  });
  for (const auto& [ending, text] : {std::pair{".ensemble.csv", report::to_csv(table)},
                                     {".ensemble.json", report::to_json(table)},
                                     {".ensemble.md", report::to_markdown(table)}}) {
    disk::write_text(world, path_of(options, in.name, ending), text);
  }
  if (world.rank() == 0) print(fmt::format("\n{}", report::to_markdown(table)));
}

}  // namespace

std::vector<Member> members(const input::Input& in) {
  const std::int64_t count = std::int64_t{in.ensemble.sets} * in.ensemble.packs;
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (in.seed > most - static_cast<std::uint64_t>(count)) {
    throw Error(ExitCode::bad_input,
                fmt::format("{}: seed: {} packs from seed {} on go beyond 2^63 - 1; use a smaller one", in.file, count,
                            in.seed));
  }
  std::vector<Member> all;
  for (int set = 1; set <= in.ensemble.sets; ++set) {
    for (int pack = 1; pack <= in.ensemble.packs; ++pack) {
      all.push_back({set, pack, in.seed + all.size(), fmt::format("{}_{}_{}", in.name, set, pack)});
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
  const std::vector<Member> all = members(in);
  std::vector<std::int64_t> codes(all.size(), 0);
  std::vector<std::int64_t> to_do(all.size(), 1);
  comm::agree_on(world, [&] {
    if (world.rank() != 0) return;
    check_free(all, options);
    for (std::size_t k = 0; k < all.size(); ++k) {
      to_do[k] = options.restart == "auto" && !options.force && finished(options, all[k]) ? 0 : 1;
    }
  });
  if (world.rank() != 0) std::ranges::fill(to_do, 0);
  world.sum(std::span(to_do));
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (to_do[k] != 0) open.push_back(k);
  }
  const auto groups = static_cast<int>(
      std::min<std::size_t>(std::max<std::size_t>(1, open.size()), static_cast<std::size_t>(world.size())));
  const int mine = static_cast<int>(std::int64_t{world.rank()} * groups / world.size());
  const comm::Comm group = world.split(mine);
  const Signals signals;
  bool stopped = false;
  for (std::size_t k = static_cast<std::size_t>(mine); k < open.size(); k += static_cast<std::size_t>(groups)) {
    const int code =
        stopped ? static_cast<int>(ExitCode::stopped_early) : make_member(group, in, all[open[k]], options);
    stopped = code == static_cast<int>(ExitCode::stopped_early);
    codes[open[k]] = code;
  }
  world.max(std::span(codes));
  log::start(world.rank(), std::nullopt, options.verbosity);
  const int code = worst(codes);
  if (code == static_cast<int>(ExitCode::stopped_early)) {
    throw Error(ExitCode::stopped_early, "stopped early; --restart auto goes on with the packs that are left");
  }
  write_tables(world, in, all, codes, options);
  return code;
}

}  // namespace packmpi::run
