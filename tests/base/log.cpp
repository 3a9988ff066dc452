#include "base/log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace packmpi::log {
namespace {

/// What the four kinds of line leave on stderr.
std::string said(Rank rank, Verbosity verbosity, const std::optional<std::string>& file = std::nullopt) {
  ::testing::internal::CaptureStderr();
  start(rank, file, verbosity);
  debug("d-line");
  info("i-line {} {0}");
  warn("w-line");
  error("e-line");
  finish();
  return ::testing::internal::GetCapturedStderr();
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Log, RankZeroSaysWhatItsVerbosityAllows) {
  const std::string quiet = said(0, Verbosity::quiet);
  EXPECT_FALSE(has(quiet, "d-line") || has(quiet, "i-line"));
  EXPECT_TRUE(has(quiet, "w-line") && has(quiet, "e-line"));
  const std::string normal = said(0, Verbosity::normal);
  EXPECT_FALSE(has(normal, "d-line"));
  EXPECT_TRUE(has(normal, "i-line {} {0}"));
  EXPECT_FALSE(has(normal, "rank"));
  EXPECT_TRUE(has(said(0, Verbosity::verbose), "d-line"));
}

TEST(Log, OtherRanksOnlyWarnAndSayWhoTheyAre) {
  const std::string words = said(3, Verbosity::verbose, "log_of_rank_3.txt");
  EXPECT_FALSE(has(words, "d-line") || has(words, "i-line"));
  EXPECT_TRUE(has(words, "rank 3: w-line"));
  EXPECT_FALSE(std::ifstream("log_of_rank_3.txt").good());
}

TEST(Log, FileGetsEverythingAndIsAppendedTo) {
  const std::string name = ::testing::TempDir() + "packmpi_log_test_" + std::to_string(getpid()) + ".txt";
  std::remove(name.c_str());
  said(0, Verbosity::quiet, name);
  said(0, Verbosity::quiet, name);
  std::stringstream text;
  text << std::ifstream(name).rdbuf();
  const std::string words = text.str();
  EXPECT_TRUE(has(words, "debug d-line") && has(words, "info i-line") && has(words, "warning w-line"));
  EXPECT_NE(words.find("d-line"), words.rfind("d-line"));
  std::remove(name.c_str());
}

TEST(Log, JsonLinesHoldTheFields) {
  const std::string name = ::testing::TempDir() + "packmpi_log_test_" + std::to_string(getpid()) + ".jsonl";
  std::remove(name.c_str());
  ::testing::internal::CaptureStderr();
  start(0, name, Verbosity::normal, Format::jsonl);
  warn("a \"quoted\" \\ word\n\xff");
  event("settled", "words", {{"layer", std::int64_t{3}}, {"height", 0.1}, {"why", std::string("duration")}});
  event_for_programs("progress", {{"share", std::nan("")}});
  finish();
  const std::string words = ::testing::internal::GetCapturedStderr();
  EXPECT_TRUE(has(words, "words") && !has(words, "progress"));
  std::ifstream file(name);
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0]["level"], "warning");
  EXPECT_EQ(lines[0]["event"], "message");
  EXPECT_TRUE(has(lines[0]["text"], "a \"quoted\" \\ word\n"));
  EXPECT_EQ(lines[1]["event"], "settled");
  EXPECT_EQ(lines[1]["layer"], 3);
  EXPECT_EQ(lines[1]["height"], 0.1);
  EXPECT_EQ(lines[1]["why"], "duration");
  EXPECT_TRUE(lines[2]["share"].is_null());
  std::remove(name.c_str());
}

TEST(Log, UnwritableFileIsAnErrorThatNamesIt) {
  try {
    start(0, "/proc/no-such-folder/x.log", Verbosity::quiet);
    FAIL() << "no error";
  } catch (const Error& failure) {
    EXPECT_EQ(failure.code(), ExitCode::io_failure);
    EXPECT_TRUE(has(failure.what(), "no-such-folder"));
  }
}

}  // namespace
}  // namespace packmpi::log
