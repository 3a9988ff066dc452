/// Every way a disk says no: the reason on every rank, nothing half-written, nothing left behind, no hang.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "disk/text_file.hpp"
#include "pack/pack.hpp"
#include "pack/samples.hpp"
#include "report/step_log.hpp"

namespace packmpi::pack {
using namespace disk;
using namespace report;
namespace {

using testing::Folder;
using testing::Spread;

/// No file of this process grows beyond `bytes` while it lives: a full disk that needs no privilege. EFBIG is its
/// errno.
class SmallFiles {
 public:
  explicit SmallFiles(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit now{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~SmallFiles() {
    setrlimit(RLIMIT_FSIZE, &before_);
    (void)std::signal(SIGXFSZ, handler_);
  }
  SmallFiles(const SmallFiles&) = delete;
  SmallFiles& operator=(const SmallFiles&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

class Failures : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  Folder folder_{comm_};
  testing::Parts parts_ =
      testing::make_parts(comm_, particles::layout_of(3, true), testing::some_grains(40000, 3), Spread::all);

  void write(const std::string& path) { write_pack(comm_, path, parts_.view(false), testing::some_record(3, 2)); }

  /// The words of the Error that `action` throws, which every rank must get; "" if it throws none.
  std::string words_of(const std::function<void()>& action, ExitCode expected = ExitCode::io_failure) {
    std::string words;
    try {
      action();
    } catch (const Error& error) {
      words = error.what();
      EXPECT_EQ(error.code(), expected) << words;
    }
    EXPECT_EQ(words, comm_.broadcast(0, words));
    return words;
  }

  [[nodiscard]] std::size_t files_in(const std::string& folder) {
    comm_.barrier();
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
  }
};

bool contains(const std::string& words, const std::string& part) { return words.find(part) != std::string::npos; }

TEST_F(Failures, MissingFolder) {
  const std::string path = folder_.file("nowhere/pack.hdf");
  for (const std::string& words :
       {words_of([&] { write(path); }), words_of([&] { write_text(comm_, path, "text"); })}) {
    EXPECT_TRUE(contains(words, "No such file or directory")) << words;
    EXPECT_TRUE(contains(words, path)) << words;
  }
  EXPECT_EQ(files_in(folder_.path()), 0u);
}

TEST_F(Failures, FolderIsAFile) {
  write_text(comm_, folder_.file("file"), "text");
  const std::string words = words_of([&] { write(folder_.file("file/pack.hdf")); });
  EXPECT_TRUE(contains(words, "Not a directory")) << words;
  EXPECT_TRUE(contains(words_of([&] { check_writable(comm_, folder_.file("file"), 1); }), "Not a directory"));
  EXPECT_TRUE(contains(words_of([&] { check_writable(comm_, folder_.file("file/more"), 1); }), "Not a directory"));
}

TEST_F(Failures, PathIsAFolder) {
  if (comm_.rank() == 0) std::filesystem::create_directory(folder_.file("pack.hdf"));
  comm_.barrier();
  const std::string words = words_of([&] { write(folder_.file("pack.hdf")); });
  EXPECT_TRUE(contains(words, "Is a directory")) << words;
  EXPECT_EQ(files_in(folder_.path()), 1u);  // no temporary
}

TEST_F(Failures, NoPermission) {
  const bool root = geteuid() == 0;
  if (comm_.rank() == 0) std::filesystem::permissions(folder_.path(), std::filesystem::perms{0555});
  comm_.barrier();
  constexpr uid_t nobody = 65534;
  const bool lowered = !root || seteuid(nobody) == 0;
  if (comm_.sum(lowered ? 0 : 1) > 0) GTEST_SKIP() << "root may write anywhere and cannot step down here";
  for (const std::string& words : {words_of([&] { check_writable(comm_, folder_.path(), 1); }),
                                   words_of([&] { write_text(comm_, folder_.file("a.json"), "text"); }), words_of([&] {
                                     SeriesMark mark;
                                     const StepLog log(comm_, folder_.file("a.csv"), mark, false);
                                   }),
                                   words_of([&] { write(folder_.file("a.hdf")); })}) {
    EXPECT_TRUE(contains(words, "Permission denied")) << words;
  }
  if (root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  EXPECT_EQ(files_in(folder_.path()), 0u);
}

TEST_F(Failures, TooLargeAFileLeavesTheOldOneAlone) {
  const std::string path = folder_.file("pack.hdf");
  write(path);
  const auto before = read_pack(path);
  parts_.layer.assign(parts_.layer.size(), 99);
  comm_.barrier();
  {
    const SmallFiles limit(1 << 18);
    const std::string words = words_of([&] { write(path); });
    EXPECT_TRUE(contains(words, "File too large")) << words;
    EXPECT_TRUE(contains(words, path)) << words;
    EXPECT_TRUE(contains(words_of([&] { check_writable(comm_, folder_.path(), 1 << 20); }), "File too large"));
    EXPECT_TRUE(contains(words_of([&] { write_text(comm_, path, std::string(1 << 20, 'x')); }), "File too large"));
  }
  EXPECT_EQ(files_in(folder_.path()), 1u);
  EXPECT_EQ(read_pack(path).layer, before.layer);
  comm_.barrier();
  write(path);  // and the library is in order afterwards
  EXPECT_EQ(read_pack(path).layer, std::vector<std::int32_t>(40000, 99));
}

TEST_F(Failures, AWriteThatFailsLateOnSomeRanksFailsOnAll) {
  const std::string path = folder_.file("pack.hdf");
  std::string words;
  {
    const SmallFiles limit(comm_.rank() == 0 ? RLIM_INFINITY : 1 << 18);  // rank 0 looks for space, and finds it
    words = words_of([&] { write(path); });
  }
  if (words.empty()) GTEST_SKIP() << "rank 0 did all the writing";
  EXPECT_TRUE(contains(words, path)) << words;
  EXPECT_EQ(files_in(folder_.path()), 0u);
  comm_.barrier();
  write(path);
  EXPECT_EQ(read_pack(path).id.size(), 40000u);
}

// Rows wait for room: the series is whole once there is some, and says how many are missing if there never is.
TEST_F(Failures, StepLogOutlivesAFullDisk) {
  const auto lines = [&] {
    std::ifstream file(folder_.file("a.csv"));
    return std::count(std::istreambuf_iterator<char>(file), {}, '\n');
  };
  for (const bool room_again : {true, false}) {
    SeriesMark mark;
    StepLog log(comm_, folder_.file("a.csv"), mark, false);
    {
      const SmallFiles limit(500);
      for (int k = 0; k < 100; ++k) log.append({.layer = k});
      if (!room_again) {
        EXPECT_LT(log.close(), 100);
      }
    }
    EXPECT_EQ(mark.rows, 100);
    if (!room_again) continue;
    log.append({.layer = 1000});
    EXPECT_EQ(log.close(), 101);
    EXPECT_EQ(lines(), 102);
    comm_.barrier();  // the next log begins the file anew, on rank 0
  }
}

TEST_F(Failures, FullDisk) {
  const std::string disk = folder_.file("disk");
  std::int64_t mounted = 0;
  if (comm_.rank() == 0) {
    std::filesystem::create_directory(disk);
    mounted = mount("none", disk.c_str(), "tmpfs", 0, "size=2m") == 0 ? 1 : 0;
  }
  if (comm_.sum(mounted) == 0) GTEST_SKIP() << "cannot mount a small disk here (not privileged)";
  for (int again = 0; again < 2; ++again) {  // 4 MB are needed
    const std::string words = words_of([&] { write(disk + "/pack.hdf"); });
    EXPECT_TRUE(contains(words, "No space left on device")) << words;
    EXPECT_EQ(files_in(disk), 0u);
    comm_.barrier();
  }
  const std::string words = words_of([&] { check_writable(comm_, disk + "/new/folder", 3 << 20); });
  EXPECT_TRUE(contains(words, "No space left on device")) << words;
  EXPECT_EQ(files_in(disk), 0u);
  comm_.barrier();
  check_writable(comm_, disk + "/new/folder", 1 << 20);
  EXPECT_EQ(files_in(disk + "/new/folder"), 0u);
  comm_.barrier();
  if (comm_.rank() == 0) {
    EXPECT_EQ(umount(disk.c_str()), 0);
  }
}

TEST_F(Failures, AnExistingFileIsReplacedInOneStep) {
  const std::string path = folder_.file("pack.hdf");
  write(path);
  std::ifstream old(path, std::ios::binary);  // keeps the old file, if it is another one
  const auto read_all = [&] { return std::string(std::istreambuf_iterator<char>(old), {}); };
  const std::string before = read_all();
  parts_.layer.assign(parts_.layer.size(), 99);
  comm_.barrier();
  write(path);
  old.clear();
  old.seekg(0);
  EXPECT_TRUE(read_all() == before);
  EXPECT_EQ(read_pack(path).layer, std::vector<std::int32_t>(40000, 99));
  EXPECT_EQ(files_in(folder_.path()), 1u);
}

TEST_F(Failures, IdsWithAGapOrTwice) {
  const auto spoil = [&](GlobalId from, GlobalId to) {
    std::size_t changed = parts_.layer.size();  // none, but on its owner
    for (std::size_t k = 0; k < parts_.layer.size(); ++k) {
      if (parts_.store.ids()[k] == from) changed = k;
    }
    const bool mine = changed < parts_.layer.size();
    if (mine) parts_.store.ids()[changed] = to;
    std::string words = words_of([&] { write(folder_.file("a.hdf")); }, ExitCode::numerical_failure);
    if (mine) parts_.store.ids()[changed] = from;
    return words;
  };
  EXPECT_TRUE(contains(spoil(7, 8), "7 is missing"));
  EXPECT_TRUE(contains(spoil(39999, 39998), "39998 is there twice"));
  EXPECT_TRUE(contains(spoil(7, 40000), "40000 is out of range"));
  EXPECT_TRUE(contains(spoil(7, -1), "-1 is out of range"));
  EXPECT_EQ(files_in(folder_.path()), 0u);
}

TEST_F(Failures, CheckWritableMakesTheFolder) {
  check_writable(comm_, folder_.file("a/b/"), 1000);
  EXPECT_EQ(files_in(folder_.file("a/b")), 0u);
  comm_.barrier();
  write(folder_.file("a/b/pack.hdf"));
  EXPECT_EQ(files_in(folder_.file("a/b")), 1u);
}

}  // namespace
}  // namespace packmpi::pack
