// Output folders: one run at a time, a finished run that is asked to go on, time series after interruptions.
#include "run/finished.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "disk/lock.hpp"
#include "input/read.hpp"
#include "pack/pack.hpp"
#include "run/make_pack.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

const std::string scene_text =
    "[container]\nsize = [0.3, 0.3, 0.05]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.25\nduration = 0.02\nmaximum = 2\n[jamming]\ngravity = 2.0\n"
    "[dynamics]\ntime_step = 1.0e-4\n[output]\nlog_every = 0.001\n";

class Folders : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_folders_" + std::to_string(::getppid()));
  std::vector<std::string> changes_;  // of the scene, as --set
  std::string words_;                 // of the last error
  report::RunRecord record_;

  void SetUp() override {
    if (comm_.rank() == 0) fs::remove_all(folder_);
    comm_.barrier();
  }
  [[nodiscard]] Options options(const std::string& restart = "") const {
    Options o;
    o.folder = folder_.string();
    o.verbosity = log::Verbosity::quiet;
    o.restart = restart;
    return o;
  }
  [[nodiscard]] scene::Scene scene() const { return scene::build(input::parse(scene_text, "box.toml", {changes_})); }
  [[nodiscard]] fs::path file(const std::string& ending) const { return folder_ / ("box" + ending); }

  /// As the program does it.
  ExitCode make(const Options& o) {
    const ExitCode code = attempt(o);
    comm_.barrier();  // rank 0 lets go of the folder last
    return code;
  }
  ExitCode attempt(const Options& o) {
    words_.clear();
    comm_.barrier();
    try {
      if (o.restart == "auto" && !o.force) {
        if (const auto finished = finished_run(comm_, scene(), o)) {
          words_ = finished->words;
          return finished->code;
        }
      }
      record_ = make_pack(comm_, scene(), o);
      return record_.targets_met ? ExitCode::done : ExitCode::target_missed;
    } catch (const Error& error) {
      words_ = error.what();
      return error.code();
    }
  }
  [[nodiscard]] std::string text_of(const std::string& ending) const {
    comm_.barrier();
    std::ifstream in(file(ending));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void on_rank_0(const std::function<void()>& action) const {
    comm_.barrier();
    if (comm_.rank() == 0) action();
    comm_.barrier();
  }
  void expect_words(const std::string& part) const {
    EXPECT_NE(words_.find(part), std::string::npos) << words_;
    EXPECT_EQ(words_.find('\n'), std::string::npos) << words_;
  }
  /// Its rows, without the number of rebuilds.
  [[nodiscard]] std::vector<std::string> series() const {
    std::istringstream lines(text_of(".steps.csv"));
    std::vector<std::string> rows;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream cells(line);
      std::string row, cell;
      for (int column = 0; std::getline(cells, cell, ','); ++column) row += column == 9 ? "" : cell + ",";
      rows.push_back(row);
    }
    return rows;
  }
};

TEST_F(Folders, AFinishedRunAnswersAndTouchesNothing) {
  EXPECT_EQ(make(options()), ExitCode::done) << words_;
  EXPECT_FALSE(fs::exists(file(".lock")));
  const auto written = fs::last_write_time(file(".hdf"));
  EXPECT_EQ(make(options("auto")), ExitCode::done);
  expect_words("box.hdf is finished, whole, and of this scene: nothing to do");
  changes_ = {"parallel.decomposition=pencil", "output.log_every=0.002"};
  EXPECT_EQ(make(options("auto")), ExitCode::done) << "these make no other pack";
  EXPECT_EQ(fs::last_write_time(file(".hdf")), written);
}

TEST_F(Folders, AFinishedRunOfAnotherSceneIsRefusedByItsKeys) {
  EXPECT_EQ(make(options()), ExitCode::done) << words_;
  for (const char* change : {"contact.friction=0.1", "seed=2", "layers.maximum=1", "output.contacts=true"}) {
    changes_ = {change};
    EXPECT_EQ(make(options("auto")), ExitCode::bad_checkpoint);
    expect_words("is of another scene: " + std::string(change).substr(0, std::string(change).find('=')) + ": ");
  }
  changes_ = {};
  on_rank_0([&] { fs::resize_file(file(".hdf"), 100); });
  EXPECT_EQ(make(options("auto")), ExitCode::bad_checkpoint);
  expect_words("cannot read " + file(".hdf").string());
  on_rank_0([&] { fs::remove(file(".hdf")); });
  EXPECT_EQ(make(options("auto")), ExitCode::done) << "what the words said: made anew. " << words_;
  EXPECT_TRUE(fs::exists(file(".hdf")));
}

TEST_F(Folders, AMissedTargetStaysMissed) {
  changes_ = {"container.size=[0.3,0.3,0.4]"};
  EXPECT_EQ(make(options()), ExitCode::target_missed) << words_;
  EXPECT_EQ(make(options("auto")), ExitCode::target_missed);
  expect_words("a target was missed");
}

TEST_F(Folders, TheAnalysisOfAKilledRunIsMade) {
  changes_ = {"output.analysis=true"};
  EXPECT_EQ(make(options()), ExitCode::done) << words_;
  const std::string whole = text_of(".analysis.json");
  EXPECT_FALSE(whole.empty());
  on_rank_0([&] { fs::remove(file(".analysis.json")); });
  EXPECT_EQ(make(options("auto")), ExitCode::done) << words_;
  EXPECT_EQ(text_of(".analysis.json"), whole);
  on_rank_0([&] { std::ofstream(file(".analysis.json")) << R"({"seal": {"pack": "0123456789abcdef"}})"; });
  EXPECT_EQ(make(options("auto")), ExitCode::done) << "of another pack: " << words_;
  EXPECT_EQ(text_of(".analysis.json"), whole);
}

TEST_F(Folders, OneRunAtATime) {
  {
    disk::Lock other;
    on_rank_0([&] {
      fs::create_directories(folder_);
      other = disk::Lock(file(".lock").string());
    });
    Options force = options();
    force.force = true;
    for (const Options& o : {options(), options("auto"), force, options("some.hdf")}) {
      EXPECT_EQ(make(o), ExitCode::bad_input);
      expect_words("box.lock is held by process " +
                   std::to_string(comm_.max(comm_.rank() == 0 ? std::int64_t{getpid()} : 0)));
    }
    EXPECT_FALSE(fs::exists(file(".log")));
  }
  on_rank_0([&] { std::ofstream(file(".lock")) << "process 1 on a machine that went down\n"; });
  EXPECT_EQ(make(options()), ExitCode::done) << "a dead run's file is no lock: " << words_;
  EXPECT_FALSE(fs::exists(file(".lock")));
  on_rank_0([&] { fs::create_directory(file(".lock")); });
  EXPECT_EQ(make(options("auto")), ExitCode::done) << "nothing is written";
  Options force = options();
  force.force = true;
  EXPECT_EQ(make(force), ExitCode::io_failure);
  expect_words("box.lock");
}

// The kernel lets go of it, whatever way the run ended.
TEST_F(Folders, ADeadRunHoldsNothing) {
  if (comm_.rank() == 0) {
    fs::create_directories(folder_);
    const std::string path = file(".lock").string();
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    const pid_t child = fork();
    if (child == 0) {
      const disk::Lock lock(path);
      (void)!write(pipe[1], "x", 1);
      ::pause();
      std::_Exit(0);
    }
    char taken = 0;
    ASSERT_EQ(read(pipe[0], &taken, 1), 1);
    EXPECT_THROW(disk::refuse_if_locked(path), Error);
    EXPECT_THROW(const disk::Lock second(path), Error);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    EXPECT_TRUE(fs::exists(path));
    EXPECT_NO_THROW(disk::refuse_if_locked(path));
    EXPECT_TRUE(disk::Lock(path).held());
    EXPECT_FALSE(fs::exists(path));
    close(pipe[0]);
    close(pipe[1]);
  }
  comm_.barrier();
}

TEST_F(Folders, ASeriesIsWholeAfterInterruptions) {
  EXPECT_EQ(make(options()), ExitCode::done) << words_;
  const std::vector<std::string> whole = series();
  EXPECT_EQ(record_.series_rows, std::ssize(whole) - 1);
  EXPECT_EQ(record_.series_rows_in_file, record_.series_rows);
  Options stop = options();
  stop.force = true;
  stop.max_steps = 105;
  EXPECT_EQ(make(stop), ExitCode::stopped_early) << words_;
  on_rank_0([&] { std::ofstream(file(".steps.csv"), std::ios::app) << "0,110,0.011,15,1.2"; });  // torn
  EXPECT_EQ(make(options("auto")), ExitCode::done) << words_;
  EXPECT_EQ(series(), whole);
  EXPECT_EQ(record_.series_rows_in_file, record_.series_rows);
}

TEST_F(Folders, ASeriesThatIsNotWholeSaysSo) {
  EXPECT_EQ(make(options()), ExitCode::done) << words_;
  const std::vector<std::string> whole = series();
  const pack::PackRows rows = pack::read_pack(file(".hdf").string());
  const std::string foreign = text_of(".steps.csv");
  const std::vector<std::function<void(const fs::path&)>> accidents{
      [](const fs::path& path) { fs::remove(path); },
      [](const fs::path& path) { fs::resize_file(path, fs::file_size(path) - 30); },
      [](const fs::path& path) { std::ofstream(path) << "step,height\n1,2\n"; },
      [&](const fs::path& path) {
        std::string other = foreign;
        other[foreign.find('\n') + 10] ^= 1;
        std::ofstream(path) << other;
      }};
  for (std::size_t k = 0; k < accidents.size(); ++k) {
    SCOPED_TRACE(k);
    Options stop = options();
    stop.force = true;
    stop.max_steps = 105;
    EXPECT_EQ(make(stop), ExitCode::stopped_early) << words_;
    on_rank_0([&] {
      accidents[k](file(".steps.csv"));
      fs::remove(file(".steps.csv.old"));
    });
    EXPECT_EQ(make(options("auto")), ExitCode::done) << words_;
    EXPECT_EQ(record_.series_rows, std::ssize(whole) - 1);
    EXPECT_EQ(record_.series_rows_in_file, record_.series_rows - 10) << "ten rows were told before";
    EXPECT_EQ(series().size(), whole.size() - 10);
    EXPECT_EQ(series().back(), whole.back());
    EXPECT_EQ(fs::exists(file(".steps.csv.old")), k != 0);
    EXPECT_EQ(pack::read_pack(file(".hdf").string()).position, rows.position);
    const auto summary = nlohmann::json::parse(text_of(".json"));
    EXPECT_EQ(summary["provenance"]["series_rows"], record_.series_rows);
    EXPECT_EQ(summary["provenance"]["series_rows_in_file"], record_.series_rows_in_file);
    EXPECT_EQ(make(options("auto")), ExitCode::done);
    expect_words("its series has");
  }
}

// The one exception of doc/restart.md: sums of implicit steps follow the lists, which a restart makes anew.
TEST_F(Folders, AnImplicitRunGoesOnToItsTolerance) {
  changes_ = {"dynamics.theta=0.5", "contact.regularisation=viscous", "contact.slip_time=1e-3",
              "layers.velocity=[0.0,0.0,-3.0]", "rest.wait=0.0"};
  EXPECT_EQ(make(options()), ExitCode::target_missed) << words_;
  const pack::PackRows whole = pack::read_pack(file(".hdf").string());
  for (const std::int64_t stop : {60, 150}) {
    Options early = options();
    early.force = true;
    early.max_steps = stop;
    EXPECT_EQ(make(early), ExitCode::stopped_early) << words_;
    EXPECT_EQ(make(options("auto")), ExitCode::target_missed) << words_;
    const pack::PackRows again = pack::read_pack(file(".hdf").string());
    ASSERT_EQ(again.id, whole.id);
    EXPECT_EQ(again.radius, whole.radius);
    for (std::size_t k = 0; k < whole.id.size(); ++k) {
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_NEAR(again.position[k][a], whole.position[k][a], 1e-9 * whole.radius[k]) << k;
      }
    }
  }
}

}  // namespace
}  // namespace packmpi::run
