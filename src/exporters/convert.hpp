/// A pack in the format of another code (doc/convert.md).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "handover/selection.hpp"

namespace packmpi::exporters {

using handover::Trim;

struct ConvertRequest {
  std::string pack;    ///< path
  std::string format;  ///< a name of convert_formats()
  std::string file{};  ///< path of what is written; "": beside the pack, with the format's ending
  Trim trim = Trim::none;
  std::string cut{};  ///< a specimen inside the pack, "cylinder:diameter=0.15,height=0.3" or "part.stl:unit=mm"
                      ///< (doc/vessels.md); "": all of it
  std::array<int, 2> copies{1, 1};  ///< side by side along x and y; more than one along periodic axes only
  bool force = false;               ///< existing files may be replaced
};

/// What was written.
struct Converted {
  std::vector<std::string> files;
  std::int64_t particles = 0, of = 0;  ///< written; of the pack and its copies
  double volume = 0.0;                 ///< [m3] of the particles as spheres; 9 digits
  std::string cut{};                   ///< in words what was cut out; "": nothing
  double cut_fraction = 0.0;           ///< its solid fraction, spheres cut by its sides, to 1e-9
  std::string springs{};               ///< what becomes of the springs of friction, in words; "": nothing to tell
};

/// One format, for help and documentation.
struct FormatWords {
  const char* name;
  const char* ending;     ///< of the file, with its first point
  const char* companion;  ///< ending of the second file; "": there is none
  const char* text;       ///< who reads it
};
[[nodiscard]] std::vector<FormatWords> convert_formats();

/// Collective. Reads the pack in batches and writes it in the format asked, each rank its share of the particles: the
/// same bytes on any number of ranks, in memory that does not depend on the particles, but for springs of friction, for
/// which rank 0 needs 1.2 kB a particle. Files appear whole or not at
/// all. Throws on all ranks, before anything is written where possible: Error(bad_input) for files that exist, a format
/// that is not known, copies along a wall; Error(io_failure) for what cannot be read or written.
Converted convert_pack(const comm::Comm& comm, const ConvertRequest& request);

}  // namespace packmpi::exporters
