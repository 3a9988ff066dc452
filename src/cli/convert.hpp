/// `packmpi convert PACK --to FORMAT`: a pack for another code.
#pragma once
#include <string>

#include "cli/options.hpp"
#include "comm/comm.hpp"

namespace packmpi::cli {

/// Collective. Writes the files (exporters/convert.hpp) and tells which; the same words on all ranks. Throws as
/// exporters::convert_pack.
[[nodiscard]] std::string convert(const comm::Comm& comm, const Request& asked);

}  // namespace packmpi::cli
