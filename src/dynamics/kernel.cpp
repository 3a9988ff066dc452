#include "dynamics/kernel.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/error.hpp"

namespace packmpi::dynamics {

// kernel_impl.cpp, compiled for each instruction set and dimension.
namespace x86_64_2d {
Kernel kernel(const scene::Features& features);
}
namespace x86_64_3d {
Kernel kernel(const scene::Features& features);
}
#ifdef PACKMPI_X86_64_LEVELS
namespace x86_64_v3_2d {
Kernel kernel(const scene::Features& features);
}
namespace x86_64_v3_3d {
Kernel kernel(const scene::Features& features);
}
namespace x86_64_v4_2d {
Kernel kernel(const scene::Features& features);
}
namespace x86_64_v4_3d {
Kernel kernel(const scene::Features& features);
}
#endif

namespace {

struct Build {
  const char* name;
  Kernel (*plane)(const scene::Features&);
  Kernel (*space)(const scene::Features&);
};

constexpr std::array builds = {
    Build{"x86-64", x86_64_2d::kernel, x86_64_3d::kernel},
#ifdef PACKMPI_X86_64_LEVELS
    Build{"x86-64-v3", x86_64_v3_2d::kernel, x86_64_v3_3d::kernel},
    Build{"x86-64-v4", x86_64_v4_2d::kernel, x86_64_v4_3d::kernel},
#endif
};

/// The best build this CPU runs, as an index.
std::size_t best_build() {
#ifdef PACKMPI_X86_64_LEVELS
  const auto has = [](auto... answers) { return (... && (answers != 0)); };
  const bool v3 = has(__builtin_cpu_supports("avx2"), __builtin_cpu_supports("bmi"), __builtin_cpu_supports("bmi2"),
                      __builtin_cpu_supports("fma"));
  const bool v4 = v3 && has(__builtin_cpu_supports("avx512f"), __builtin_cpu_supports("avx512bw"),
                            __builtin_cpu_supports("avx512cd"), __builtin_cpu_supports("avx512dq"),
                            __builtin_cpu_supports("avx512vl"));
  return v4 ? 2 : (v3 ? 1 : 0);
#else
  return 0;
#endif
}

const Build& chosen_build() {
  const std::size_t best = best_build();
  const char* wish = std::getenv("PACKMPI_ARCH");
  if (wish == nullptr || *wish == '\0') return builds[best];
  for (std::size_t b = 0; b < builds.size(); ++b) {
    if (std::string_view(wish) == builds[b].name) return builds[b < best ? b : best];
  }
  throw Error(ExitCode::bad_input, std::string("PACKMPI_ARCH=") + wish +
                                       " is not known; use x86-64, x86-64-v3 or x86-64-v4, or leave it unset");
}

}  // namespace

StepReport together(const StepReport& a, const StepReport& b) {
  const auto larger = [](double x, double y) { return std::isnan(x) || x > y ? x : y; };
  return {larger(a.max_speed, b.max_speed), larger(a.max_force, b.max_force), a.in_range && b.in_range};
}

Kernel select_kernel(const scene::Features& features) {
  const Build& build = chosen_build();
  return features.dimension == 3 ? build.space(features) : build.plane(features);
}

const char* kernel_architecture() { return chosen_build().name; }

}  // namespace packmpi::dynamics
