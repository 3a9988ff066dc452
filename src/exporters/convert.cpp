#include "exporters/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "disk/files.hpp"
#include "exporters/formats.hpp"
#include "exporters/quote.hpp"
#include "exporters/rows_file.hpp"
#include "handover/cut.hpp"
#include "handover/specimen.hpp"
#include "input/read.hpp"
#include "mesh/file.hpp"
#include "pack/pack_file.hpp"

namespace packmpi::exporters {
namespace {

[[noreturn]] void refuse_request(const std::string& words) { throw Error(ExitCode::bad_input, words); }

const Format& format_of(const std::string& name) {
  std::vector<std::string> names;
  std::string list;
  for (const Format& format : formats()) {
    if (name == format.words.name) return format;
    names.emplace_back(format.words.name);
    list += (list.empty() ? "" : ", ") + names.back();
  }
  const auto near = text::closest(name, names);
  refuse_request(fmt::format("--to {}: no such format{}; there are {}", name,
                             near ? fmt::format(" (did you mean {}?)", *near) : "", list));
}

/// The request with its file named, and the companion's path ("" if the format has none).
struct Names {
  ConvertRequest request;
  std::string companion;
  std::string third = "";  // of a mesh or of springs, for formats that have them in a file

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> all{request.file};
    for (const std::string& one : {companion, third}) {
      if (!one.empty()) all.push_back(one);
    }
    return all;
  }
};

Names name_files(ConvertRequest request, const FormatWords& words) {
  if (request.file.empty()) {
    std::filesystem::path path = request.pack;
    if (path.extension() == ".hdf") path.replace_extension();
    request.file = path.string() + words.ending;
  }
  check_file_name(std::filesystem::path(request.file).filename().string());
  if (*words.companion == '\0') return {request, ""};
  const std::string companion = std::filesystem::path(request.file).replace_extension(words.companion).string();
  if (companion == request.file) {
    refuse_request(fmt::format("-o {}: this name is that of the second file of {}; choose another ending", request.file,
                               words.name));
  }
  return {request, companion};
}

void check_free(const Names& names) {
  for (const std::string& path : names.files()) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    if (std::filesystem::is_directory(path, ignored))
      refuse_request(path + " is a folder; -o wants the name of a file");
    if (std::filesystem::equivalent(path, names.request.pack, ignored)) refuse_request(path + " is the pack itself");
    if (!names.request.force) refuse_request(path + " exists; use --force to replace it, or -o FILE");
  }
}

void check_copies(const ConvertRequest& request, const geometry::Container& box) {
  for (int axis = 0; axis < 2; ++axis) {
    const int n = request.copies[static_cast<std::size_t>(axis)];
    if (n < 1) refuse_request("--replicate: the numbers of copies must be 1 or more");
    if (n == 1) continue;
    if (axis >= box.lateral_axes()) refuse_request("--replicate: a 2D pack has no second lateral axis; use NX or NX,1");
    if (!box.periodic[static_cast<std::size_t>(axis)]) {
      refuse_request(
          fmt::format("--replicate: {} ends in walls, so copies would not fit together there; only periodic axes can "
                      "be replicated",
                      "xy"[axis]));
    }
  }
}

// Formats that carry particles alone, without what stands around them.
constexpr std::array<std::string_view, 4> without_walls{"csv", "xyz", "vtk", "esys"};

/// What is above H_d bears the lid.
void check_trim(const ConvertRequest& request, const geometry::Container& vessel) {
  const bool alone = std::ranges::find(without_walls, request.format) != without_walls.end();
  if (request.trim == Trim::none || !vessel.lid || alone) return;
  refuse_request(fmt::format(
      "--trim: this pack stands under a lid at {:g} m, and what is left out below it bears its stress; take a "
      "specimen out by --cut, or write csv, xyz, vtk or esys, which carry particles alone",
      *vessel.lid));
}

void check_cut(const ConvertRequest& request) {
  if (request.cut.empty()) return;
  const char* other = request.trim != Trim::none ? "--trim" : "";
  if (request.copies[0] * request.copies[1] > 1) other = "--replicate";
  if (*other != '\0') {
    refuse_request(
        fmt::format("--cut {}: takes a specimen out of the pack as it is; give it without {}", request.cut, other));
  }
}

/// The materials of several components are carried by some formats only.
void check_components(const ConvertRequest& request, const scene::Scene& scene) {
  constexpr std::array<std::string_view, 5> able{"lammps", "liggghts", "yade", "csv", "vtk"};
  if (!scene.features.mixture || std::ranges::find(able, request.format) != able.end()) return;
  refuse_request(
      fmt::format("--to {}: it is written with one material, and the pack has {} components; use lammps, "
                  "liggghts, yade, csv or vtk",
                  request.format, scene.in.components.size()));
}

/// Walls that are neither flat nor a cylinder seen from inside are carried by some formats only.
void check_vessel(const ConvertRequest& request, const geometry::Container& vessel, bool mixture) {
  using geometry::Shape;
  struct Carried {
    std::string_view format;
    std::vector<Shape> shapes;
  };
  std::array<Carried, 3> able{Carried{"lammps", {Shape::frustum, Shape::sphere, Shape::annulus}},
                              Carried{"liggghts", {Shape::annulus, Shape::mesh}},
                              Carried{"yade", {Shape::frustum, Shape::sphere, Shape::annulus, Shape::mesh}}};
  if (vessel.dimension == 2) {  // a circle is an upright cylinder there
    able = {Carried{"lammps", {Shape::sphere, Shape::polygon}}, Carried{"liggghts", {Shape::sphere}},
            Carried{"yade", {Shape::sphere, Shape::polygon}}};
  }
  const bool usual = vessel.is_box() || vessel.shape == Shape::cylinder;
  if (usual || std::ranges::find(without_walls, request.format) != without_walls.end()) return;
  std::string names;
  for (const Carried& one : able) {
    if (std::ranges::find(one.shapes, vessel.shape) == one.shapes.end()) continue;
    if (one.format == request.format) return;
    names += fmt::format("{}{}", names.empty() ? "" : " or ", one.format);
  }
  const bool flat = vessel.dimension == 2;
  refuse_request(
      fmt::format("--to {}: the walls of this pack's vessel are not written for it; use {}, or {}, "
                  "which carry particles alone; or take a {} out of it by --cut",
                  request.format, names, mixture ? "csv or vtk" : "csv, xyz, vtk or esys",
                  flat ? "rectangle" : "box or a cylinder"));
}

/// The scene a pack was made from; what is wrong with it is wrong with the pack.
scene::Scene scene_of(const pack::PackFile& file) {
  try {
    scene::Scene scene = scene::build(input::parse(file.scene(), "the scene in it", {}));
    confine::apply(file.confined(), scene.container);
    return scene;
  } catch (const Error& error) {
    throw Error(ExitCode::io_failure, error.what());
  }
}

/// Runs the local `action` on all ranks; an io_failure is told with the path of the pack.
template <class Action>
void reading(const comm::Comm& comm, const std::string& path, Action&& action) {
  comm::agree_on(comm, [&] {
    try {
      action();
    } catch (const Error& error) {
      if (error.code() != ExitCode::io_failure) throw;
      throw Error(error.code(), fmt::format("cannot read {}: {}", path, error.what()));
    }
  });
}

/// The ending of a third file; "" if there is none.
std::string third_ending(const ConvertRequest& request, const scene::Scene& scene, const Format& format, bool springs) {
  const bool facets = scene.container.is_mesh() && request.cut.empty();
  if (facets && format.words.name == std::string_view("liggghts")) return ".stl";
  return springs && format.springs == SpringsBy::forces ? ".springs" : "";
}

/// Temporary files first, then their names.
void write_files(const comm::Comm& comm, const Names& names, const Document& document, const Selection& selection) {
  const std::string& path = names.request.file;
  const std::string temporary = path + ".tmp";
  try {
    write_rows_file(comm, temporary, document, selection);
    comm::agree_on(comm, [&] {
      if (comm.rank() != 0) return;
      if (!names.companion.empty()) disk::write_whole(names.companion, document.companion);
      if (!names.third.empty()) disk::write_whole(names.third, document.third);
      disk::commit(temporary, path);
    });
  } catch (const comm::AgreedError&) {  // every rank is here
    if (comm.rank() == 0) disk::discard(temporary);
    throw;
  }
}

}  // namespace

std::vector<FormatWords> convert_formats() {
  std::vector<FormatWords> words;
  for (const Format& format : formats()) words.push_back(format.words);
  return words;
}

Converted convert_pack(const comm::Comm& comm, const ConvertRequest& request) {
  const disk::h5::Quiet quiet;
  const Format& format = format_of(request.format);  // pure: all ranks throw the same
  Names names = name_files(request, format.words);
  std::optional<pack::PackFile> file;
  scene::Scene scene;
  reading(comm, request.pack, [&] {
    file.emplace(request.pack);
    scene = scene_of(*file);
  });
  pack::check_pack(comm, request.pack);
  check_copies(request, scene.container);
  check_components(request, scene);
  check_cut(request);
  check_trim(request, scene.container);
  const std::string file_of_cut = handover::Cut::file_of(request.cut);
  const std::string surface = file_of_cut.empty() ? "" : mesh::read_file(comm, file_of_cut);
  const handover::Cut cut =
      request.cut.empty() ? handover::Cut() : handover::Cut(request.cut, scene, surface);  // pure, as check_copies() is
  if (!cut.on()) check_vessel(request, scene.container, scene.features.mixture);
  SpringsPlan springs = plan_springs(request, scene, format.springs, file->has_springs());
  if (const std::string ending = third_ending(request, scene, format, springs.on()); !ending.empty()) {
    names.third = std::filesystem::path(names.request.file).replace_extension(ending).string();
  }
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0) check_free(names);
  });
  const Selection selection(*file, scene, {request.pack, request.trim, request.copies}, cut);
  Specimen specimen = survey(comm, *file, selection, scene);
  specimen.file = std::filesystem::path(names.request.file).filename().string();
  if (cut.on() && specimen.count == 0) {
    comm::fail_together(
        comm, ExitCode::bad_input,
        fmt::format("--cut {}: no particle of {} lies wholly in it; make it larger", request.cut, request.pack));
  }
  take_springs(comm, *file, springs, specimen);
  write_files(comm, names, format.make(specimen), selection);
  return {names.files(), specimen.count,        selection.places(),         specimen.volume,
          specimen.cut,  specimen.cut_fraction, words_of(springs, specimen)};
}

}  // namespace packmpi::exporters
