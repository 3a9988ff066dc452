#include "base/signals.hpp"

#include <array>
#include <csignal>
#include <cstddef>

namespace packmpi {
namespace {

volatile std::sig_atomic_t checkpoint_wanted = 0;
volatile std::sig_atomic_t stop_wanted = 0;
volatile std::sig_atomic_t ended_before = 0;  // by TERM or INT

constexpr std::array<int, 4> caught{SIGUSR1, SIGUSR2, SIGTERM, SIGINT};
std::array<struct sigaction, caught.size()> former;

extern "C" void packmpi_on_signal(int number) {
  if (number == SIGUSR1) {
    checkpoint_wanted = 1;
    return;
  }
  stop_wanted = 1;
  if (number == SIGUSR2) return;
  if (ended_before != 0) {  // the second one: as if it had never been caught
    (void)std::signal(number, SIG_DFL);
    (void)std::raise(number);
  }
  ended_before = 1;
}

struct sigaction our_action() {
  struct sigaction action {};
  action.sa_handler = packmpi_on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  return action;
}

}  // namespace

void keep_user_signals() {
  const struct sigaction action = our_action();
  for (const int number : {SIGUSR1, SIGUSR2}) sigaction(number, &action, nullptr);
}

// The flags are not cleared: what came before the run began is meant for it.
Signals::Signals() {
  ended_before = 0;
  const struct sigaction action = our_action();
  for (std::size_t k = 0; k < caught.size(); ++k) sigaction(caught[k], &action, &former[k]);
}

Signals::~Signals() {
  for (std::size_t k = 0; k < caught.size(); ++k) sigaction(caught[k], &former[k], nullptr);
  checkpoint_wanted = 0;
  stop_wanted = 0;
}

Wish take_wish() {
  if (stop_wanted != 0) return Wish::stop;
  if (checkpoint_wanted == 0) return Wish::none;
  checkpoint_wanted = 0;
  return Wish::checkpoint;
}

bool stop_wished() { return stop_wanted != 0; }

}  // namespace packmpi
