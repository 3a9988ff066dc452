/// Files beside a scene that it names: curves and lists of sizes, surfaces.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "comm/comm.hpp"
#include "config/input.hpp"
#include "document/document.hpp"
#include "tables/sieve_table.hpp"

namespace packmpi::input {

using tables::CurveFile;

inline constexpr std::string_view curve_file_key = "particles.radius.diameter_curve_file";
inline constexpr std::string_view list_file_key = "particles.radius.list_file";
inline constexpr std::string_view mesh_file_key = "container.file";

/// As they were read from the disk.
struct NamedFiles {
  std::optional<CurveFile> curve = {};   ///< of sizes
  std::vector<CurveFile> surfaces = {};  ///< of the container, and of obstacles
};

/// The text of a file of `what`. Throws Error(bad_input).
[[nodiscard]] std::string file_text(const std::string& path, std::string_view what, std::size_t longest);

/// Reads what a scene names (its sizes have the names of radii, and its obstacles are apart), from its folder. Local.
/// Throws Error(bad_input).
[[nodiscard]] NamedFiles read_named(const document::Document& document, const std::vector<Obstacle>& obstacles,
                                    const std::string& scene);

/// Collective. Those of rank 0 on all.
[[nodiscard]] NamedFiles broadcast(const comm::Comm& comm, const NamedFiles& files);

/// A scene may be a stranger's: it names files in its folder or below it only. Throws Error(bad_input) of `place`.
void check_name(const std::string& place, std::string_view key, const std::string& name, std::string_view what);

}  // namespace packmpi::input
