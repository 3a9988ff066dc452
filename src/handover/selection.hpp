/// The particles of a pack as another code gets them: trimmed, cut out, copied, numbered.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "handover/cut.hpp"
#include "pack/pack_file.hpp"
#include "pack/pack_plan.hpp"
#include "scene/scene.hpp"

namespace packmpi::handover {

/// What becomes of particles that are higher than the target height, H_d.
enum class Trim {
  none,
  drop,  ///< every particle that reaches above H_d is left out
  cut    ///< those with their centre above H_d are left out: the plane cuts by halves, spheres stay whole
};

/// What of a pack is taken.
struct Choice {
  std::string pack;  ///< path
  Trim trim = Trim::none;
  std::array<int, 2> copies{1, 1};  ///< side by side along x and y
};

/// A particle on its way out. `row.id` counts from 1: row of the pack + 1, plus N for each copy before; ids of trimmed
/// particles are left out.
struct Outgoing {
  pack::ParticleRow row;
  std::int64_t index;  ///< among those written, from 0
};

/// The list of outgoing particles, read batch by batch; never whole in memory. Rank-local.
class Selection {
 public:
  /// Both must live as long.
  Selection(const pack::PackFile& file, const scene::Scene& scene, const Choice& choice, const Cut& cut)
      : file_(&file), scene_(&scene), choice_(choice), cut_(cut) {}

  /// Places in the list: particles times copies. Trimmed particles have a place and are passed over.
  [[nodiscard]] std::int64_t places() const { return file_->count() * choice_.copies[0] * choice_.copies[1]; }
  [[nodiscard]] bool trims() const { return choice_.trim != Trim::none || cut_.on(); }
  [[nodiscard]] const Choice& choice() const { return choice_; }
  [[nodiscard]] const Cut& cut() const { return cut_; }
  /// Of the particles of places [begin, end) what is in the specimen that is cut out, a quantum each rounded.
  [[nodiscard]] std::int64_t solid_quanta(std::int64_t begin, std::int64_t end, double quanta_a_volume) const;
  /// Calls take(row) for the particles of places [begin, end) in turn. Error(io_failure) if the pack is damaged.
  void visit(std::int64_t begin, std::int64_t end, const std::function<void(const pack::ParticleRow&)>& take) const;

 private:
  [[nodiscard]] bool kept(const pack::ParticleRow& row) const;
  [[nodiscard]] pack::PackRows read(std::int64_t first, std::int64_t count) const;
  void visit_batch(std::int64_t copy, const pack::PackRows& rows,
                   const std::function<void(const pack::ParticleRow&)>& take) const;

  const pack::PackFile* file_;
  const scene::Scene* scene_;
  Choice choice_;
  Cut cut_;
};

}  // namespace packmpi::handover
