#include "dynamics/near_field.hpp"

#include <cmath>

#include "base/elementary.hpp"
#include "dynamics/kernel.hpp"
#include "geometry/container.hpp"

namespace packmpi::dynamics {
namespace {

/// x^n by squaring.
double whole_power(double x, std::int64_t n) {
  double result = 1.0;
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) result *= x;
    x *= x;
  }
  return result;
}

}  // namespace

double inverse_power(double d, double exponent) {
  constexpr double most = 512.0;  // beyond, the value is 0 or infinite for any length in metres
  const double halves = std::nearbyint(2.0 * std::fabs(exponent));
  if (!(halves <= most)) return elementary::power(d, -exponent);
  const auto count = static_cast<std::int64_t>(halves);
  double power = whole_power(d, count / 2);
  if (count % 2 == 1) power *= std::sqrt(d);
  const double rest = std::fabs(exponent) - 0.5 * halves;  // a quarter at most: its power keeps all digits
  if (rest != 0.0) power *= elementary::power(d, rest);
  return exponent < 0.0 ? power : 1.0 / power;
}

bool add_near_field(const scene::Scene& scene, const particles::Store& store, const neighbor::PairList& pairs,
                    std::int64_t* accumulators) {
  const input::NearField& law = *scene.in.near_field;
  const int each = accumulators_of(store.layout());
  const double limit = max_quanta * scene.force_quantum;
  bool in_range = true;
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const LocalIndex i = pairs.first[p];
    const LocalIndex j = pairs.second[p];
    const Vec3 x = geometry::separation(scene.container, store.position(i), store.position(j));
    const double distance = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (distance == 0.0 || distance >= law.cutoff) continue;
    const double attraction = law.alpha1 * inverse_power(distance, law.beta1);
    const double repulsion = law.alpha2 * inverse_power(distance, law.beta2);
    const double force = attraction - repulsion;
    if (!(std::fabs(force) <= limit)) {  // NaN too
      in_range = false;
      continue;
    }
    for (int a = 0; a < store.layout().dimension; ++a) {
      const double component = force * (x[static_cast<std::size_t>(a)] / distance);
      const auto quanta = static_cast<std::int64_t>(std::nearbyint(component / scene.force_quantum));
      accumulators[std::int64_t{i} * each + a] += quanta;
      if (j < store.owned()) accumulators[std::int64_t{j} * each + a] -= quanta;
    }
  }
  return in_range;
}

}  // namespace packmpi::dynamics
