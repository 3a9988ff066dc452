/// What a run is asked beside its scene.
#pragma once
#include <cstdint>
#include <string>

#include "base/log.hpp"
#include "input/read.hpp"

namespace packmpi::run {

/// How and where a scene is to be packed.
struct Options {
  std::string scene;           ///< path of the TOML file
  std::string folder = ".";    ///< where outputs go
  input::Overrides overrides;  ///< --set, --seed
  bool force = false;          ///< existing outputs may be replaced
  std::string restart;         ///< "auto", a checkpoint file, or "": from the beginning
  double max_hours = 0.0;      ///< [h] of wall time, then a checkpoint and the end; 0: no limit
  std::int64_t max_steps = 0;  ///< of this run, then the same; 0: no limit
  bool member = false;         ///< of an ensemble, which looks for STOP before each of its packs
  log::Verbosity verbosity = log::Verbosity::normal;
  log::Format log_format = log::Format::text;
};

}  // namespace packmpi::run
