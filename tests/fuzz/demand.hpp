/// What must hold whatever a file says.
#pragma once
#include <sys/time.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace packmpi::fuzz {

/// Ends the fuzzer with these words unless `holds`: a finding.
inline void demand(bool holds, const std::string& words) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", words.c_str());
  std::abort();
}

/// Runs `action`, which may take a second: of the processor, since a busy machine's clock says nothing. libFuzzer's own
/// -timeout is for what waits for ever.
template <class Action>
void within_a_second(Action&& action) {
  (void)std::signal(SIGPROF, [](int) { demand(false, "it takes more than a second"); });
  itimerval limit{{0, 0}, {1, 0}};
  setitimer(ITIMER_PROF, &limit, nullptr);
  action();
  limit = {};
  setitimer(ITIMER_PROF, &limit, nullptr);
}

}  // namespace packmpi::fuzz
