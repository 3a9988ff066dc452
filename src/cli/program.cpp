#include "cli/program.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <system_error>
#include <thread>

#include "base/log.hpp"
#include "base/memory.hpp"
#include "base/signals.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "cli/convert.hpp"
#include "cli/info.hpp"
#include "cli/starter.hpp"
#include "comm/petsc.hpp"
#include "config/restitution.hpp"
#include "disk/text_file.hpp"
#include "ensemble/ensemble.hpp"
#include "forecast/advice.hpp"
#include "forecast/estimate.hpp"
#include "forecast/limits.hpp"
#include "input/fidelity.hpp"
#include "report/report.hpp"
#include "run/analyze.hpp"
#include "run/files.hpp"
#include "run/finished.hpp"
#include "run/make_pack.hpp"
#include "run/start.hpp"
#include "scene/expectation.hpp"
#include "scene/ownership.hpp"
#include "start/fit.hpp"

namespace packmpi::cli {
namespace {

// The effective scene for people: a surface of many triangles is told, not shown.
std::string effective_to_show(const input::Input& in) {
  constexpr std::size_t shown = 2000;
  const std::size_t begin = in.effective.find("\nsurface = ");
  const std::size_t end = in.effective.find('\n', begin + 1);
  if (in.container.mesh == nullptr || begin == std::string::npos || end - begin < shown) return in.effective;
  return in.effective.substr(0, begin) +
         fmt::format("\n# surface = the lines of an OBJ file, {} triangles: packs have them",
                     in.container.mesh->shell().triangles.size()) +
         in.effective.substr(end);
}

std::string step_words(const scene::Scene& scene) {
  if (insertion_alone(scene.in)) return "";
  return fmt::format("# time step {:g} s; limit of eq. (23) {:.3g} s for the smallest particles\n", scene.time_step,
                     scene::safe_time_step(scene.in, scene.sizes));
}

// `packmpi check`: the scene as it will be used, and what follows from it.
int check(const comm::Comm& comm, const scene::Scene& scene) {
  run::check_start(comm, scene);
  const scene::Ownership ownership(comm, scene.columns(), scene.in.parallel.decomposition);
  if (comm.rank() == 0) {
    const auto [nx, ny] = ownership.grid().counts();
    std::string words = fmt::format(
        "{}\n# {} is valid.\n{}"
        "# lateral grid {} x {} columns: at most {} ranks\n# about {} particles{} (packmpi estimate)\n",
        effective_to_show(scene.in), scene.in.file, step_words(scene), nx, ny, run::most_ranks(scene),
        scene::expected_filling(scene, scene::expected_fraction(scene).value).particles,
        scene.in.start ? " in all, if those of [start] are like the scene's" : "");
    for (const std::string& remark : scene.in.remarks) words += fmt::format("# {}\n", remark);
    if (const auto fines = scene::fines(scene)) words += fmt::format("# {}\n", forecast::fines_words(*fines));
    if (insertion_alone(scene.in)) {
      print(words + "# insertion alone: no step is taken\n");
      return 0;
    }
    const double modulus = scene.in.particles.youngs_modulus;
    words += fmt::format("# mean overlap at rest about {:.2g} radii; 1 % would be at a modulus of {:.1e} Pa\n",
                         scene::expected_overlap(scene, modulus), scene::modulus_for(scene, 0.01, modulus));
    words += fmt::format("# restitution {:.4f} of two particles (damping_ratio {:.4g})\n",
                         input::restitution_of(scene.in.contact.damping_ratio, scene.in.contact.tension_cutoff),
                         scene.in.contact.damping_ratio);
    words +=
        fmt::format("# time step of layers {:g} s, relaxation {:g} s\n", scene.settling.time_step, scene.relaxation);
    if (scene.in.particles.count > 0) {
      words += fmt::format("# particles.count: they come to a height of about {:.3g} m\n",
                           scene::expected_filling(scene, scene::expected_fraction(scene).value).height);
    }
    words += fmt::format("# fidelity = \"{}\":\n", scene.in.fidelity);
    for (const std::string& line : input::preset_in_use(scene.in)) words += fmt::format("#   {}\n", line);
    if (const std::string note = forecast::preset_note(scene); !note.empty()) words += fmt::format("# {}\n", note);
    print(words);
  }
  return 0;
}

int make(const comm::Comm& comm, const scene::Scene& scene, const run::Options& options) {
  const Signals signals;
  if (options.restart == "auto" && !options.force) {
    if (const auto finished = run::finished_run(comm, scene, options)) {
      if (comm.rank() == 0) print(finished->words + "\n");
      return static_cast<int>(finished->code);
    }
  }
  const report::RunRecord record = run::make_pack(comm, scene, options);
  const bool met = record.targets_met;
  if (comm.rank() == 0) {
    log::info(fmt::format("{} in {}", met ? "done" : "finished, but a target was missed",
                          text::duration(record.wall_seconds)));
    if (options.verbosity == log::Verbosity::verbose) print(report::to_table(record) + "\n");
    const run::Files files = run::files_of(record.name, options);
    std::vector<std::string> written;
    for (const std::string& file : {files.pack, files.summary, files.log, files.steps})
      if (run::is_there(file)) written.push_back(file);
    if (scene.in.output.analysis) written.push_back(files.analysis);
    print(report::to_lines(record, written));
  }
  return static_cast<int>(met ? ExitCode::done : ExitCode::target_missed);
}

// `packmpi init`: a scene to begin with.
int begin_scene(const comm::Comm& comm, const Request& request) {
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0 && !request.run.force && std::filesystem::exists(request.run.scene)) {
      throw Error(ExitCode::bad_input, request.run.scene + " exists; use --force to replace it");
    }
  });
  disk::write_text(comm, request.run.scene, starter(request.dimension));
  log::info(fmt::format("{} written; edit it, then: packmpi check {}", request.run.scene, request.run.scene));
  return 0;
}

// What is printed for a command that only tells; the same words on all ranks.
std::string told(const comm::Comm& comm, const Request& request) {
  if (request.command == Command::tool) {  // alone, it would have begun before MPI (cli/tools.hpp)
    throw Error(ExitCode::bad_input, fmt::format("packmpi {} is one process: start it without mpirun", request.name));
  }
  if (request.command == Command::info) return describe_file(comm, request.run.scene);
  if (request.command == Command::analyze) return run::analyze(comm, request.run.scene);
  if (request.command == Command::convert) return convert(comm, request);
  if (request.command == Command::limits) {
    const report::LimitsReport found = forecast::limits(comm, request.run.scene, request.run.overrides);
    return request.question.json ? report::to_json(found) : report::to_table(found);
  }
  const report::Estimate told = forecast::estimate(comm, request.run.scene, request.run.overrides, request.question);
  return request.question.json ? report::to_json(told) : report::to_table(told);
}

// Of `run` and `check`.
int use_scene(const comm::Comm& comm, const Request& request) {
  const Occupation now("the scene and its lateral grid");
  const input::Input in = start::with_start(comm, input::read(comm, request.run.scene, request.run.overrides));
  comm::petsc_options(in.petsc.options);
  const scene::Scene scene = scene::build(in);  // pure: all ranks throw the same
  expect_memory(forecast::memory_a_rank(scene, comm.size()));
  const bool many = in.ensemble.sets * in.ensemble.packs > 1;
  if (many) (void)ensemble::members(in);  // have they seeds?
  if (request.command == Command::run && many) return ensemble::make_ensemble(comm, in, request.run);
  const int on_machine = comm.ranks_on_machine();
  if (comm.rank() == 0) {
    for (const std::string& words : forecast::warnings_of(scene)) log::warn(words);
    const auto cores = static_cast<int>(std::thread::hardware_concurrency());
    if (request.command == Command::run) {
      for (const std::string& words : forecast::notes_of(scene, comm.size(), on_machine, cores)) log::warn(words);
      if (const std::string words = forecast::preset_note(scene); !words.empty()) log::info(words);
    }
  }
  return request.command == Command::check ? check(comm, scene) : make(comm, scene, request.run);
}

int act(const comm::Comm& comm, const Request& request) {
  log::start(comm.rank(), std::nullopt, request.run.verbosity);
  if (request.command == Command::init) return begin_scene(comm, request);
  if (request.command == Command::run || request.command == Command::check) return use_scene(comm, request);
  const std::string words = told(comm, request);
  if (comm.rank() == 0) print(words);
  return 0;
}

int answer(const comm::Comm& comm, int argc, const char* const* argv) {
  const auto parsed = parse_command_line(argc, argv);
  const Reply* reply = std::get_if<Reply>(&parsed);
  if (reply == nullptr) return act(comm, std::get<Request>(parsed));
  if (comm.rank() == 0 && reply->code == 0) print(reply->text);
  if (comm.rank() == 0 && reply->code != 0) std::fputs(reply->text.c_str(), stderr);
  return reply->code;
}

// What was printed must have arrived.
void check_stdout(const comm::Comm& comm) {
  comm::agree_on(comm, [] {
    if (const int number = stdout_failure(); number != 0) {
      throw Error(ExitCode::io_failure, fmt::format("cannot write to the standard output: {}; files are not concerned",
                                                    std::generic_category().message(number)));
    }
  });
}

}  // namespace

int program(MPI_Comm world, int argc, const char* const* argv) {
  const comm::Comm comm(world);
  int code = 0;
  const comm::Failure failure = comm::end_together(comm, [&] {
    code = answer(comm, argc, argv);
    check_stdout(comm);
  });
  if (failure.code != ExitCode::done) {
    const bool stopped = failure.code == ExitCode::stopped_early;
    if (comm.rank() == 0) stopped ? log::warn(failure.words) : log::error(failure.words);
    code = static_cast<int>(failure.code);
  }
  log::finish();
  return code;
}

}  // namespace packmpi::cli
