// How ranks come to one end: errors that all throw, and those of one rank alone.
#include <algorithm>
#include <chrono>
#include <new>
#include <thread>

#include "base/memory.hpp"
#include "comm/comm.hpp"
#include "comm/session.hpp"

namespace packmpi::comm {
namespace {

using Clock = std::chrono::steady_clock;

/// Whether all ranks of `aside` came to `barrier` in time.
bool all_came(MPI_Request& barrier, Clock::time_point end) {
  int done = 0;
  while (MPI_Test(&barrier, &done, MPI_STATUS_IGNORE), done == 0 && Clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return done != 0;
}

/// The failure of the lowest rank, if all ranks have one; else the end of the job. Of two that failed alone, the lower
/// rank is to be heard: its end is the end of the other.
Failure meet(const Comm& aside, const Failure& mine, double patience) {
  constexpr int most_steps = 20;
  constexpr double step = 0.1;  // [s]
  const double wait = patience + step * std::min(aside.rank(), most_steps);
  MPI_Request barrier = MPI_REQUEST_NULL;
  MPI_Ibarrier(aside.handle(), &barrier);
  if (!all_came(barrier,
                Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait))))
    abort_all(static_cast<int>(mine.code), "rank " + std::to_string(aside.rank()) + ": " + mine.words);
  try {
    agree(aside, mine.code, mine.words);
  } catch (const AgreedError& error) {
    return {error.code(), error.what()};
  }
  return mine;  // not reached: all have words
}

}  // namespace

Failure caught(ExitCode otherwise) {
  try {
    throw;
  } catch (const Error& error) {
    return {error.code(), error.what()};
  } catch (const std::bad_alloc& error) {
    return {ExitCode::numerical_failure, memory_words(error)};
  } catch (const std::exception& error) {
    return {otherwise, error.what()};
  } catch (...) {
    return {otherwise, "an exception of an unknown type"};
  }
}

void agree(const Comm& comm, ExitCode code, const std::optional<std::string>& complaint) {
  const auto first = comm.min(complaint ? std::int64_t{comm.rank()} : std::int64_t{comm.size()});
  if (first == comm.size()) return;
  const std::string mine = static_cast<char>(code) + complaint.value_or("");
  const std::string theirs = comm.broadcast(static_cast<Rank>(first), mine);
  throw AgreedError(static_cast<ExitCode>(theirs[0]), theirs.substr(1));
}

void fail_together(const Comm& comm, ExitCode code, const std::string& words) {
  agree(comm, code, words);
  abort_all(static_cast<int>(code), words);  // not reached: there are words
}

Failure end_together(const Comm& comm, const std::function<void()>& action, double patience) {
  const Comm aside(comm.handle());  // where nothing else is under way
  try {
    action();
    return {};
  } catch (const AgreedError& error) {
    return {error.code(), error.what()};
  } catch (...) {
    return meet(aside, caught(ExitCode::numerical_failure), patience);
  }
}

}  // namespace packmpi::comm
