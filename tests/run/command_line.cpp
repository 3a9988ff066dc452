// The command line as a struct: every option, every refusal.
#include <gtest/gtest.h>

#include "run/options.hpp"

namespace packmpi::run {
namespace {

std::variant<Options, Reply> parse(std::vector<const char*> words) {
  words.insert(words.begin(), "packmpi");
  return parse_command_line(static_cast<int>(words.size()), words.data());
}

TEST(CommandLine, ASceneAloneIsRun) {
  const auto options = std::get<Options>(parse({"a.toml"}));
  EXPECT_EQ(options.command, Command::run);
  EXPECT_EQ(options.scene, "a.toml");
  EXPECT_EQ(options.folder, ".");
  EXPECT_FALSE(options.force);
  EXPECT_EQ(options.verbosity, log::Verbosity::normal);
}

TEST(CommandLine, CommandsAndOptions) {
  EXPECT_EQ(std::get<Options>(parse({"check", "a.toml"})).command, Command::check);
  EXPECT_EQ(std::get<Options>(parse({"run", "a.toml"})).command, Command::run);
  const auto options = std::get<Options>(parse(
      {"--set", "layers.duration=0.5", "a.toml", "--set", "seed=3", "--seed", "4", "-o", "out", "--force", "-q"}));
  EXPECT_EQ(options.scene, "a.toml");
  EXPECT_EQ(options.overrides.set, (std::vector<std::string>{"layers.duration=0.5", "seed=3", "seed=4"}));
  EXPECT_EQ(options.folder, "out");
  EXPECT_TRUE(options.force);
  EXPECT_EQ(options.verbosity, log::Verbosity::quiet);
}

TEST(CommandLine, HelpAndVersionAreAnswersNotErrors) {
  const auto help = std::get<Reply>(parse({"--help"}));
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.text.find("packmpi check SCENE.toml"), std::string::npos);
  const auto version = std::get<Reply>(parse({"--version"}));
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.text.rfind("packmpi ", 0), 0U);
}

TEST(CommandLine, MisuseIsExitCodeTwo) {
  for (const std::vector<const char*>& words : {std::vector<const char*>{},
                                                {"run"},
                                                {"a.toml", "b.toml"},
                                                {"a.toml", "--sed", "3"},
                                                {"a.toml", "--seed", "x"},
                                                {"a.toml", "--set"}}) {
    const auto reply = std::get<Reply>(parse(words));
    EXPECT_EQ(reply.code, 2);
    EXPECT_FALSE(reply.text.empty());
  }
}

}  // namespace
}  // namespace packmpi::run
