/// Who follows a bed while it is filled.
#pragma once
#include <cstdint>
#include <limits>
#include <string>

#include "base/types.hpp"
#include "control/filling.hpp"
#include "report/record.hpp"

namespace packmpi::run {

struct Bed;

/// What fill() and settle() tell, and whom they ask. Here: nobody listens, and nothing ends the bed before its end.
class Attendant {
 public:
  Attendant() = default;
  Attendant(const Attendant&) = delete;
  Attendant& operator=(const Attendant&) = delete;
  virtual ~Attendant() = default;

  virtual void layer_inserted(const report::LayerRow&) {}
  virtual void moment(double /*share*/) {}    ///< collective; `share` of the present part is done, 0 .. 1
  virtual void remark(const std::string&) {}  ///< a line for the log
  virtual void layer_settled(const report::LayerRow&) {}
  virtual void layer_measured(const control::Filling&) {}  ///< towards a target: what its newest entries are
  virtual void relaxation_started() {}                     ///< collective; all particles move from now on
  virtual void relaxation_not_needed() {}
  virtual void relaxed(double /*height*/, double /*duration*/) {}  ///< [m], [s]
  /// Collective. The bed is filled, and its record whole; its files, if it has any, are not yet written.
  virtual void measured(const Bed&, const report::RunRecord&) {}
  /// Steps to make until the next look(); the same on all ranks, at least 1.
  [[nodiscard]] virtual std::int64_t steps_to_look() const { return std::numeric_limits<std::int32_t>::max(); }
  virtual void look() {}         ///< collective; may end the run by an Error
  virtual void layer_ended() {}  ///< likewise
  /// Likewise; owned particles from slot `before` on are those of the layer that is being inserted.
  virtual void look_while_inserting(LocalIndex /*before*/) {}
};

}  // namespace packmpi::run
