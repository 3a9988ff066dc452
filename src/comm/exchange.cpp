// Who sends to me? Non-blocking consensus (Hoefler, Siebert, Lumsdaine 2010, "NBX"): synchronous sends end when they
// are being received, so once every rank's sends have ended nothing is under way, and a non-blocking barrier says so.
#include <algorithm>
#include <cassert>

#include "comm/comm.hpp"

namespace packmpi::comm {
namespace {

void check(const Comm& comm, const std::vector<Parcel>& outgoing) {
  std::vector<Rank> ranks;
  for (const Parcel& parcel : outgoing) {
    assert(parcel.rank >= 0 && parcel.rank < comm.size());
    ranks.push_back(parcel.rank);
  }
  std::sort(ranks.begin(), ranks.end());
  assert(std::adjacent_find(ranks.begin(), ranks.end()) == ranks.end() && "two parcels to one rank");
}

// MPI counts in ints, so a long parcel is several messages; an empty one is one, too.
std::vector<MPI_Request> send(const Comm& comm, const std::vector<Parcel>& outgoing, int tag, Purpose purpose,
                              int longest) {
  std::vector<MPI_Request> requests;
  const auto most = static_cast<std::size_t>(longest);
  for (const Parcel& parcel : outgoing) {
    if (parcel.rank == comm.rank()) continue;
    std::size_t at = 0;
    do {
      const std::size_t count = std::min(most, parcel.bytes.size() - at);
      requests.emplace_back();
      MPI_Issend(parcel.bytes.data() + at, static_cast<int>(count), MPI_BYTE, parcel.rank, tag, comm.handle(),
                 &requests.back());
      comm.count(purpose, {1, static_cast<std::int64_t>(count)});
      at += count;
    } while (at < parcel.bytes.size());
  }
  return requests;
}

/// Takes one message of this exchange if there is one. Those of one rank come in the order they were sent in, and are
/// parts of one parcel.
void receive_one(const Comm& comm, int tag, std::vector<Parcel>& incoming) {
  int found = 0;
  MPI_Message message = MPI_MESSAGE_NULL;
  MPI_Status status;
  MPI_Improbe(MPI_ANY_SOURCE, tag, comm.handle(), &found, &message, &status);
  if (found == 0) return;
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  auto parcel = std::ranges::find(incoming, status.MPI_SOURCE, &Parcel::rank);
  if (parcel == incoming.end()) parcel = incoming.insert(incoming.end(), Parcel{status.MPI_SOURCE, {}});
  const std::size_t before = parcel->bytes.size();
  parcel->bytes.resize(before + static_cast<std::size_t>(count));
  MPI_Mrecv(parcel->bytes.data() + before, count, MPI_BYTE, &message, MPI_STATUS_IGNORE);
}

bool all_ended(std::vector<MPI_Request>& requests) {
  int done = 0;
  MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
  return done != 0;
}

void receive_until_all_ranks_are_done(const Comm& comm, int tag, std::vector<MPI_Request>& sends,
                                      std::vector<Parcel>& incoming) {
  while (!all_ended(sends)) receive_one(comm, tag, incoming);
  MPI_Request barrier = MPI_REQUEST_NULL;
  MPI_Ibarrier(comm.handle(), &barrier);
  for (int done = 0; done == 0; MPI_Test(&barrier, &done, MPI_STATUS_IGNORE)) receive_one(comm, tag, incoming);
}

}  // namespace

std::vector<Parcel> exchange(const Comm& comm, std::vector<Parcel> outgoing, Purpose purpose, int longest_message) {
  assert(longest_message > 0);
  check(comm, outgoing);
  ++comm.counters_.exchanges;
  // A rank that has left this exchange may send in the next one while another still receives in this one; nobody can be
  // two ahead, for the barrier of the next needs all. So two tags in turn keep them apart.
  const int tag = comm.odd_exchange_ ? 1 : 0;
  comm.odd_exchange_ = !comm.odd_exchange_;
  std::vector<MPI_Request> sends = send(comm, outgoing, tag, purpose, longest_message);
  std::vector<Parcel> incoming;
  receive_until_all_ranks_are_done(comm, tag, sends, incoming);
  for (Parcel& parcel : outgoing) {
    if (parcel.rank == comm.rank()) incoming.push_back(std::move(parcel));
  }
  std::sort(incoming.begin(), incoming.end(), [](const Parcel& a, const Parcel& b) { return a.rank < b.rank; });
  return incoming;
}

}  // namespace packmpi::comm
