#include "comm/comm.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace packmpi::comm {
namespace {

using Limits = std::numeric_limits<std::int64_t>;

int count_of(std::size_t n) {
  assert(n <= static_cast<std::size_t>(std::numeric_limits<int>::max()));
  return static_cast<int>(n);
}

std::int64_t flip_negative(std::int64_t bits) { return bits < 0 ? bits ^ Limits::max() : bits; }

/// An integer that orders as the double does: MPI's own MAX of doubles leaves NaN and signed zeros to chance.
std::int64_t key_of(double x, std::int64_t key_of_nan) {
  return std::isnan(x) ? key_of_nan : flip_negative(std::bit_cast<std::int64_t>(x));
}

/// The inverse of key_of; the extreme keys, which NaN was given, are the bits of NaNs.
double value_of(std::int64_t key) {
  if (key == Limits::max() || key == Limits::min()) return std::numeric_limits<double>::quiet_NaN();
  return std::bit_cast<double>(flip_negative(key));
}

}  // namespace

Comm::Comm(MPI_Comm parent) {
  MPI_Comm_dup(parent, &comm_);
  MPI_Comm_set_errhandler(comm_, MPI_ERRORS_ARE_FATAL);
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &size_);
}

Comm Comm::split(int color) const {
  MPI_Comm part = MPI_COMM_NULL;
  MPI_Comm_split(comm_, color, rank_, &part);
  Comm result(part);
  MPI_Comm_free(&part);
  return result;
}

Comm::~Comm() {
  if (comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
}

Comm::Comm(Comm&& other) noexcept
    : comm_(std::exchange(other.comm_, MPI_COMM_NULL)),
      rank_(other.rank_),
      size_(other.size_),
      odd_exchange_(other.odd_exchange_),
      counters_(other.counters_) {}

std::int64_t Comm::reduce(std::int64_t mine, MPI_Op operation) const {
  ++counters_.reductions;
  std::int64_t all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_INT64_T, operation, comm_);
  return all;
}

void Comm::reduce(std::span<std::int64_t> values, MPI_Op operation) const {
  ++counters_.reductions;
  const int count = count_of(values.size());
  // NOLINTNEXTLINE(mpi-type-mismatch): the check does not know that int64_t is long here
  MPI_Allreduce(MPI_IN_PLACE, values.data(), count, MPI_INT64_T, operation, comm_);
}

void Comm::count(Purpose purpose, Traffic traffic) const noexcept {
  Traffic& sent = counters_.sent[static_cast<std::size_t>(purpose)];
  sent.messages += traffic.messages;
  sent.bytes += traffic.bytes;
}

int Comm::ranks_on_machine() const {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  int ranks = 1;
  MPI_Comm_size(machine, &ranks);
  MPI_Comm_free(&machine);
  return ranks;
}

void Comm::barrier() const { MPI_Barrier(comm_); }

std::int64_t Comm::sum(std::int64_t mine) const { return reduce(mine, MPI_SUM); }
std::int64_t Comm::min(std::int64_t mine) const { return reduce(mine, MPI_MIN); }
std::int64_t Comm::max(std::int64_t mine) const { return reduce(mine, MPI_MAX); }

double Comm::min(double mine) const { return value_of(min(key_of(mine, Limits::min()))); }
double Comm::max(double mine) const { return value_of(max(key_of(mine, Limits::max()))); }

void Comm::sum(std::span<std::int64_t> values) const { reduce(values, MPI_SUM); }
void Comm::max(std::span<std::int64_t> values) const { reduce(values, MPI_MAX); }

void Comm::max(std::span<double> values) const {
  std::vector<std::int64_t> keys(values.size());
  std::transform(values.begin(), values.end(), keys.begin(), [](double x) { return key_of(x, Limits::max()); });
  max(std::span(keys));
  std::transform(keys.begin(), keys.end(), values.begin(), value_of);
}

std::int64_t Comm::sum_below(std::int64_t mine) const {
  ++counters_.reductions;
  std::int64_t below = 0;
  MPI_Exscan(&mine, &below, 1, MPI_INT64_T, MPI_SUM, comm_);
  return rank_ == 0 ? 0 : below;  // MPI leaves rank 0's result undefined
}

std::string Comm::broadcast(Rank root, std::string_view words) const {
  auto length = static_cast<std::int64_t>(words.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, root, comm_);
  std::string all = rank_ == root ? std::string(words) : std::string(static_cast<std::size_t>(length), '\0');
  constexpr std::size_t piece = std::size_t{1} << 30U;  // MPI counts in int
  for (std::size_t done = 0; done < all.size(); done += piece) {
    MPI_Bcast(all.data() + done, count_of(std::min(piece, all.size() - done)), MPI_CHAR, root, comm_);
  }
  return all;
}

std::vector<std::int64_t> Comm::gather(std::span<const std::int64_t> mine) const {
  std::vector<std::int64_t> all(rank_ == 0 ? mine.size() * static_cast<std::size_t>(size_) : 0);
  const int count = count_of(mine.size());
  // NOLINTNEXTLINE(mpi-type-mismatch): as in reduce()
  MPI_Gather(mine.data(), count, MPI_INT64_T, all.data(), count, MPI_INT64_T, 0, comm_);
  return all;
}

}  // namespace packmpi::comm
