/// Surfaces out of files, on all ranks.
#pragma once
#include <memory>
#include <string>

#include "comm/comm.hpp"
#include "mesh/surface.hpp"

namespace packmpi::mesh {

/// Collective. The bytes of a file, read by rank 0, which may not be larger than most_bytes. Throws Error(bad_input)
/// that begins with `path` on every rank.
[[nodiscard]] std::string read_file(const comm::Comm& comm, const std::string& path);

/// The surface that `bytes` of the file `path` hold, lengths times `unit` [m]. Throws Error(bad_input) that begins with
/// `path`. Pure.
[[nodiscard]] std::shared_ptr<const Surface> make_surface(const std::string& bytes, const std::string& path,
                                                          double unit);

/// ", 3 triangles without an area left out, 5 turned outside"; "" if nothing had to be mended.
[[nodiscard]] std::string mended_words(const Mended& mended);

}  // namespace packmpi::mesh
