#include "config/named_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "base/text.hpp"
#include "config/mesh_vessel.hpp"

namespace packmpi::input {

using document::Document;
using document::Node;

namespace {

constexpr std::size_t longest_mesh = std::size_t{64} << 20U;  // bytes of its file

const std::string* text_at(const Document& document, std::string_view key) {
  const Node* node = document.find(key);
  const auto* name = node == nullptr ? nullptr : std::get_if<std::string>(&node->value);
  return name == nullptr || name->empty() ? nullptr : name;
}

std::optional<CurveFile> curve_of(const Document& document, const std::string& scene) {
  const std::string_view key = document.find(list_file_key) != nullptr ? list_file_key : curve_file_key;
  const std::string* name = text_at(document, key);
  const bool both = document.find(key == curve_file_key ? "particles.radius.diameter_curve"
                                                        : "particles.radius.radii") != nullptr;  // parse() refuses that
  if (name == nullptr || both) return std::nullopt;
  check_name(document.place(key), key, *name, key == curve_file_key ? "curve" : "list");
  const std::string file = beside(scene, *name);
  return CurveFile{file, file_text(file, "a CSV file", Document::longest_file)};
}

}  // namespace

std::string file_text(const std::string& path, std::string_view what, std::size_t longest) {
  const auto refuse = [&](const std::string& words) { throw Error(ExitCode::bad_input, path + ": " + words); };
  const RegularFile file(path);
  const std::string& flaw = file.flaw();
  if (!flaw.empty()) refuse(flaw + (flaw.starts_with("cannot") ? "; check the path" : fmt::format("; give {}", what)));
  const std::optional<std::string> text = file.read(0, static_cast<std::int64_t>(longest) + 1);
  if (!text) refuse("cannot be read to its end; check the file system");
  if (text->size() > longest) refuse(fmt::format("is longer than {}; is it {}?", text::bytes(longest), what));
  return *text;
}

void check_name(const std::string& place, std::string_view key, const std::string& name, std::string_view what) {
  const std::filesystem::path path(name);
  if (!path.is_absolute() && std::ranges::find(path, "..") == path.end()) return;
  document::fail(place, key,
                 fmt::format("is {}; a {} lies in the scene's folder or below it: give a path from there, without "
                             "\"..\"",
                             tables::toml_string(name), what));
}

NamedFiles read_named(const Document& document, const std::vector<Obstacle>& obstacles, const std::string& scene) {
  NamedFiles files{curve_of(document, scene), {}};
  const auto take = [&](const std::string& name) {
    const std::string path = beside(scene, name);
    if (std::ranges::find(files.surfaces, path, &CurveFile::path) == files.surfaces.end())
      files.surfaces.push_back({path, file_text(path, "an STL or OBJ file", longest_mesh)});
  };
  const std::string* shape = text_at(document, "container.shape");
  const std::string* name = text_at(document, mesh_file_key);
  if (name != nullptr && shape != nullptr && *shape == "mesh") {
    check_name(document.place(mesh_file_key), mesh_file_key, *name, "mesh");
    take(*name);
  }
  for (const Obstacle& one : obstacles) {
    if (!one.file.empty()) take(one.file);
  }
  return files;
}

NamedFiles broadcast(const comm::Comm& comm, const NamedFiles& files) {
  const auto one = [&](const CurveFile& file) {
    return CurveFile{comm.broadcast(0, file.path), comm.broadcast(0, file.text)};
  };
  NamedFiles all;
  const CurveFile curve = one(files.curve.value_or(CurveFile{}));
  if (!curve.path.empty()) all.curve = curve;
  const auto count = std::stoull(comm.broadcast(0, std::to_string(files.surfaces.size())));
  for (std::size_t k = 0; k < count; ++k) {
    all.surfaces.push_back(one(comm.rank() == 0 ? files.surfaces[k] : CurveFile{}));
  }
  return all;
}

}  // namespace packmpi::input
