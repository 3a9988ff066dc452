/// `packmpi estimate`: what a scene will take, and the one of particles, height and floor that is left open.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "input/read.hpp"
#include "report/estimate.hpp"
#include "scene/scene.hpp"

namespace packmpi::forecast {

/// What `estimate` is asked; nothing: what the scene as it is comes to.
struct Question {
  std::optional<std::int64_t> particles{};
  std::optional<double> height{};              ///< [m] H_d
  std::vector<std::optional<double>> sides{};  ///< [m] of the floor, none: open; empty: those of the scene
  std::optional<double> fraction{};            ///< [-] of the bed, instead of the estimate
  int ranks = 0;                               ///< 0: those that are here
  bool probe = true;
  bool json = false;
};

/// Collective. What the scene of that path takes, as `question` asks; nothing is written. Throws Error(bad_input) for
/// questions that have no answer or several, and for scenes that `check` would refuse.
[[nodiscard]] report::Estimate estimate(const comm::Comm& comm, const std::string& path,
                                        const input::Overrides& overrides, const Question& question);

/// The same of a scene that was read.
[[nodiscard]] report::Estimate estimate(const comm::Comm& comm, const input::Input& in, const Question& question);

/// Sum over the layers of the particles that move while each settles, and over the final stage, times their steps.
/// Local, pure.
[[nodiscard]] std::int64_t particle_steps_of(const scene::Scene& scene, std::int64_t layers, std::int64_t a_layer);

/// Memory that a rank of `ranks` has at most in a run of this scene [B]. Local, pure.
[[nodiscard]] std::int64_t memory_a_rank(const scene::Scene& scene, int ranks);

}  // namespace packmpi::forecast
