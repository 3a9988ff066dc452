/// NAME.json, read back.
#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace packmpi::report {

/// What a run says of its pack, as far as others build on it.
struct Summary {
  std::uint64_t pack_seal = 0;  ///< of the pack that it is of (pack::seal_of())
  bool targets_met = false;
  std::int64_t series_rows = 0, series_rows_in_file = 0;
  std::map<std::string, double> achieved;  ///< the numbers under this name
};

/// The summary at `path`, which must be as it was written. Rank-local. Throws Error(io_failure): "PATH what is wrong".
[[nodiscard]] Summary read_summary(const std::string& path);

/// The seal of the pack that an analysis (NAME.analysis.json) is of; 0 if there is no such file, or none that can be
/// read. Rank-local.
[[nodiscard]] std::uint64_t pack_of_analysis(const std::string& path);

}  // namespace packmpi::report
