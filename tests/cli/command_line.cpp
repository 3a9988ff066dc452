// The command line as a struct: every option, every refusal.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "cli/options.hpp"
#include "cli/tools.hpp"

namespace packmpi::cli {
namespace {

std::variant<Request, Reply> parse(std::vector<const char*> words) {
  words.insert(words.begin(), "packmpi");
  return parse_command_line(static_cast<int>(words.size()), words.data());
}

TEST(CommandLine, ASceneAloneIsRun) {
  const auto options = std::get<Request>(parse({"a.toml"}));
  EXPECT_EQ(options.command, Command::run);
  EXPECT_EQ(options.run.scene, "a.toml");
  EXPECT_EQ(options.run.folder, ".");
  EXPECT_FALSE(options.run.force);
  EXPECT_EQ(options.run.verbosity, log::Verbosity::normal);
}

TEST(CommandLine, CommandsAndOptions) {
  EXPECT_EQ(std::get<Request>(parse({"check", "a.toml"})).command, Command::check);
  EXPECT_EQ(std::get<Request>(parse({"run", "a.toml"})).command, Command::run);
  const auto options = std::get<Request>(parse(
      {"--set", "layers.duration=0.5", "a.toml", "--set", "seed=3", "--seed", "4", "-o", "out", "--force", "-q"}));
  EXPECT_EQ(options.run.scene, "a.toml");
  EXPECT_EQ(options.run.overrides.set, (std::vector<std::string>{"layers.duration=0.5", "seed=3", "seed=4"}));
  EXPECT_EQ(options.run.folder, "out");
  EXPECT_TRUE(options.run.force);
  EXPECT_EQ(options.run.verbosity, log::Verbosity::quiet);
}

TEST(CommandLine, TyposAreAnswered) {
  const auto said = [](std::vector<const char*> words) {
    const Reply reply = std::get<Reply>(parse(std::move(words)));
    EXPECT_EQ(reply.code, 2);
    return reply.text;
  };
  EXPECT_EQ(said({"chekc", "a.toml"}),
            "packmpi: there is no command \"chekc\", and no scene of that name; did you mean \"check\"?\n");
  EXPECT_NE(said({"run", "a.toml", "--sede", "3"}).find("--sede: did you mean \"--seed\"?"), std::string::npos);
  EXPECT_NE(said({"a.toml", "--ouptut=x"}).find("--ouptut: did you mean \"--output\"?"), std::string::npos);
  EXPECT_EQ(said({"a.toml", "--quite-another"}).find("did you mean"), std::string::npos);
  EXPECT_EQ(std::get<Request>(parse({"cheek.toml"})).run.scene, "cheek.toml");  // a file, there or not
  EXPECT_EQ(std::get<Request>(parse({"something"})).run.scene, "something");    // near to nothing
}

TEST(CommandLine, HelpHasExamples) {
  const Reply help = std::get<Reply>(parse({"--help"}));
  EXPECT_EQ(help.code, 0);
  for (const EndWords& example : example_words()) EXPECT_NE(help.text.find(example.term), std::string::npos);
}

TEST(CommandLine, ToolsBeginBeforeMpiAndAlone) {
  const auto wants = [](std::vector<const char*> words) {
    words.insert(words.begin(), "packmpi");
    return wants_tool(static_cast<int>(words.size()), words.data());
  };
  // This test runs under mpirun, where no tool begins; there, the command line knows the command, and keeps its
  // options.
  EXPECT_FALSE(wants({"report", "a.hdf"}));
  const auto options = std::get<Request>(parse({"report", "a.hdf", "--size", "300"}));
  EXPECT_EQ(options.command, Command::tool);
  EXPECT_EQ(options.name, "report");
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_NAMESPACE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"})
    unsetenv(name);
  EXPECT_TRUE(wants({"report", "a.hdf"}));
  EXPECT_TRUE(wants({"render", "a.hdf"}));
  EXPECT_FALSE(wants({"a.toml"}));
  EXPECT_FALSE(wants({}));
}

TEST(CommandLine, EstimateAsksForWhatIsOpen) {
  const auto options =
      std::get<Request>(parse({"estimate", "a.toml", "--particles", "1000", "--height", "50 cm", "--floor", "0.2,open",
                               "--ranks", "4", "--no-probe", "--json", "--fraction", "0.6"}));
  EXPECT_EQ(options.command, Command::estimate);
  EXPECT_EQ(options.question.particles, 1000);
  EXPECT_EQ(options.question.height, 0.5);
  EXPECT_EQ(options.question.sides, (std::vector<std::optional<double>>{0.2, std::nullopt}));
  EXPECT_EQ(options.question.fraction, 0.6);
  EXPECT_EQ(options.question.ranks, 4);
  EXPECT_FALSE(options.question.probe);
  EXPECT_TRUE(options.question.json);
  EXPECT_TRUE(std::get<Request>(parse({"estimate", "a.toml"})).question.probe);
  for (const std::vector<const char*>& words : {std::vector<const char*>{"--particles", "0"},
                                                {"--particles", "-3"},
                                                {"--height", "tall"},
                                                {"--height", "-1"},
                                                {"--floor", "0.2,?"},
                                                {"--floor", "0,1"},
                                                {"--fraction", "1.5"},
                                                {"--ranks", "0"}}) {
    const auto reply = std::get<Reply>(parse({"estimate", "a.toml", words[0], words[1]}));
    EXPECT_EQ(reply.code, 2) << words[0] << " " << words[1];
    EXPECT_NE(reply.text.find(words[0]), std::string::npos) << reply.text;
  }
}

// Each is refused in one short line that names the option and the word.
TEST(CommandLine, NumbersAreNumbers) {
  for (const char* command : {"run", "estimate"}) {
    const bool run = std::string(command) == "run";
    const std::vector<const char*> names =
        run ? std::vector<const char*>{"--max-hours", "--max-steps", "--seed"}
            : std::vector<const char*>{"--particles", "--height", "--floor", "--fraction", "--ranks", "--seed"};
    for (const char* name : names) {
      for (const char* word :
           {"nan", "-nan", "inf", "-inf", "abc", "1e999", "99999999999999999999", "-1", "0x10", "1 2", ""}) {
        if (std::string(word) == "99999999999999999999" && std::string(name) != "--max-steps") continue;
        const auto parsed = parse({command, "a.toml", name, word});
        const Reply* reply = std::get_if<Reply>(&parsed);
        ASSERT_NE(reply, nullptr) << name << " " << word << " is taken";
        EXPECT_EQ(reply->code, 2) << name << " " << word;
        const std::string line = reply->text.substr(0, reply->text.find('\n'));
        EXPECT_LT(line.size(), 120U) << line;
        EXPECT_NE(line.find(name), std::string::npos) << line;
      }
    }
  }
  EXPECT_EQ(std::get<Reply>(parse({"a.toml", "--max-steps", "9223372036854775807"})).code, 2);
  EXPECT_EQ(std::get<Reply>(parse({"a.toml", "--max-steps", "0"})).code, 2);
  EXPECT_EQ(std::get<Reply>(parse({"a.toml", "--max-hours", "0"})).code, 2);
  EXPECT_EQ(std::get<Request>(parse({"a.toml", "--max-steps", "1000000000000000"})).run.max_steps, 1000000000000000);
  EXPECT_EQ(std::get<Request>(parse({"a.toml", "--max-hours", "0.5"})).run.max_hours, 0.5);
  EXPECT_EQ(std::get<Reply>(parse({"init", "--dimension", "nan"})).code, 2);
  EXPECT_EQ(std::get<Reply>(parse({"convert", "a.hdf", "--to", "csv", "--replicate", "99999999999,1"})).code, 2);
}

TEST(CommandLine, HelpAndVersionAreAnswersNotErrors) {
  const auto help = std::get<Reply>(parse({"--help"}));
  EXPECT_EQ(help.code, 0);
  for (const char* words : {"check", "info", "USR2", "75"})
    EXPECT_NE(help.text.find(words), std::string::npos) << words;
  const auto run_help = std::get<Reply>(parse({"a.toml", "--help"}));
  EXPECT_EQ(run_help.code, 0);
  EXPECT_NE(run_help.text.find("--max-hours"), std::string::npos);
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

std::string answer(const std::vector<const char*>& words) { return std::get<Reply>(parse(words)).text; }

TEST(CommandLine, ManualAndCompletionsNameEveryOption) {
  std::string manual = answer({"manual"});
  std::erase(manual, '\\');
  const std::vector<std::string> shells{answer({"completion", "bash"}), answer({"completion", "zsh"}),
                                        answer({"completion", "fish"})};
  int options = 0;
  for (const CommandWords& command : command_words()) {
    EXPECT_NE(manual.find("packmpi " + command.name), std::string::npos) << command.name;
    for (const std::string& shell : shells) EXPECT_NE(shell.find(command.name), std::string::npos) << command.name;
    for (const OptionWords& option : command.options) {
      const std::string& name = option.names.back();
      EXPECT_NE(manual.find(name), std::string::npos) << name;
      EXPECT_NE(shells[0].find(name), std::string::npos) << name;
      EXPECT_NE(shells[1].find(name), std::string::npos) << name;
      EXPECT_NE(shells[2].find("-l " + name.substr(2)), std::string::npos) << name;
      ++options;
    }
  }
  EXPECT_GE(options, 11);
  for (const EndWords& code : exit_code_words()) EXPECT_NE(manual.find(code.text.substr(0, 12)), std::string::npos);
}

/// What bash offers after these words.
std::string bash_offers(const std::string& words, int at) {
  const std::string script = answer({"completion", "bash"}) + "COMP_WORDS=(" + words +
                             "); COMP_CWORD=" + std::to_string(at) + "; _packmpi; echo \"${COMPREPLY[*]}\"\n";
  const std::string path = testing::TempDir() + "packmpi_completion_" + std::to_string(::getpid());
  std::ofstream(path) << script;
  FILE* pipe = popen(("bash " + path).c_str(), "r");
  std::string out;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) out += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0);
  return out;
}

TEST(CommandLine, BashCompletes) {
  EXPECT_EQ(bash_offers("packmpi com", 1), "completion\n");
  EXPECT_EQ(bash_offers("packmpi completion f", 2), "fish\n");
  EXPECT_EQ(bash_offers("packmpi a.toml --max", 2), "--max-hours --max-steps\n");
  EXPECT_EQ(bash_offers("packmpi check a.toml --", 3), "--help --set --seed\n");
}

}  // namespace
}  // namespace packmpi::cli
