/// `packmpi convert PACK --to FORMAT`: a pack for another code.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "run/options.hpp"

namespace packmpi::run {

/// Collective. Writes the files (output/convert.hpp) and tells which; the same words on all ranks. Throws as
/// output::convert_pack.
[[nodiscard]] std::string convert(const comm::Comm& comm, const Options& options);

}  // namespace packmpi::run
