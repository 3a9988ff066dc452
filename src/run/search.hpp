/// Which friction, while layers are filled in, gives a density; and which densities there are.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "control/filling.hpp"
#include "run/trial.hpp"

namespace packmpi::run {

/// Samples that a search fills in at most.
[[nodiscard]] std::int64_t most_trials(const control::Sample& sample);

/// The densest and the loosest state of a scene, the mean over seeds: the scene's own and those after it.
struct Extremes {
  std::vector<std::uint64_t> seeds;
  std::vector<control::Trial> densest, loosest;  ///< a seed each
  [[nodiscard]] control::Limits limits() const;
};
inline constexpr int seeds_of_extremes = 3;

/// Collective; ranks share the samples, and the result has the same bits on any number of them. Errors of a sample are
/// those of all ranks. Cost: 2 seeds_of_extremes samples.
[[nodiscard]] Extremes find_extremes(const comm::Comm& comm, const scene::Scene& scene, const Look& look = {});

/// Collective, likewise. How a run with a target begins: the sample's curve and the knob of the first layer. Of a scene
/// that is its own sample the best knob that was tried, and no curve: nothing is to be corrected. Throws
/// Error(bad_input) on all ranks for a density that the sample cannot have within the tolerance, with its limits. Cost:
/// most_trials() samples at most, and those of find_extremes() for a relative density.
[[nodiscard]] control::Filling find_filling(const comm::Comm& comm, const scene::Scene& scene, const Look& look = {});

/// "target.porosity": the key that names the density. Local.
[[nodiscard]] std::string target_key(const input::Target& target);

}  // namespace packmpi::run
