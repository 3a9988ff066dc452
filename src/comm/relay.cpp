// Two hops in place of one: ranks stand in rows of about sqrt(P), a parcel goes along its sender's row to the column of
// its destination and down that column. All that takes the same way travels in one message.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <span>
#include <utility>

#include "base/release.hpp"
#include "comm/comm.hpp"

namespace packmpi::comm {
namespace {

/// Before the bytes of a parcel on its way.
struct Label {
  std::int64_t length;
  Rank from, to;
};

/// Rank r stands at (r / width, r % width); the last row may be short.
class Square {
 public:
  explicit Square(int size) : size_(size), width_(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(size))))) {}

  /// Whom `from` gives what is for `to`: in the column of `to`, and in the row of `from` if that reaches so far, else
  /// in the row above.
  [[nodiscard]] Rank between(Rank from, Rank to) const {
    const Rank rank = from / width_ * width_ + to % width_;
    return rank < size_ ? rank : rank - width_;
  }

 private:
  int size_, width_;
};

void append(std::vector<std::byte>& message, const Label& label, std::span<const std::byte> bytes) {
  const std::size_t before = message.size();
  message.resize(before + sizeof label + bytes.size());
  std::memcpy(message.data() + before, &label, sizeof label);
  std::ranges::copy(bytes, message.begin() + static_cast<std::ptrdiff_t>(before + sizeof label));
}

template <class What>
void for_each_parcel(const std::vector<Parcel>& messages, What&& what) {
  for (const Parcel& message : messages) {
    for (std::size_t at = 0; at < message.bytes.size();) {
      Label label{};
      std::memcpy(&label, message.bytes.data() + at, sizeof label);
      at += sizeof label;
      what(label, std::span(message.bytes).subspan(at, static_cast<std::size_t>(label.length)));
      at += static_cast<std::size_t>(label.length);
    }
  }
}

/// Messages in the making, one for each next rank.
class Bundles {
 public:
  explicit Bundles(const std::map<Rank, std::size_t>& bytes) {
    messages_.reserve(bytes.size());
    for (const auto& [rank, size] : bytes) {
      place_[rank] = messages_.size();
      messages_.push_back({rank, {}});
      messages_.back().bytes.reserve(size);
    }
  }
  void add(Rank next, const Label& label, std::span<const std::byte> bytes) {
    append(messages_[place_.at(next)].bytes, label, bytes);
  }
  [[nodiscard]] std::vector<Parcel> take() { return std::move(messages_); }

 private:
  std::map<Rank, std::size_t> place_;
  std::vector<Parcel> messages_;
};

std::vector<Parcel> along_the_row(const Comm& comm, std::vector<Parcel> outgoing) {
  const Square square(comm.size());
  std::map<Rank, std::size_t> sizes;
  for (const Parcel& parcel : outgoing) {
    sizes[square.between(comm.rank(), parcel.rank)] += sizeof(Label) + parcel.bytes.size();
  }
  Bundles bundles(sizes);
  for (Parcel& parcel : outgoing) {
    const Label label{std::ssize(parcel.bytes), comm.rank(), parcel.rank};
    bundles.add(square.between(comm.rank(), parcel.rank), label, parcel.bytes);
    release(parcel.bytes);  // it is in the bundle now
  }
  return bundles.take();
}

std::vector<Parcel> down_the_column(const std::vector<Parcel>& passing) {
  std::map<Rank, std::size_t> sizes;
  for_each_parcel(passing, [&](const Label& label, std::span<const std::byte> bytes) {
    sizes[label.to] += sizeof label + bytes.size();
  });
  Bundles bundles(sizes);
  for_each_parcel(passing,
                  [&](const Label& label, std::span<const std::byte> bytes) { bundles.add(label.to, label, bytes); });
  return bundles.take();
}

}  // namespace

std::vector<Parcel> relay(const Comm& comm, std::vector<Parcel> outgoing, Purpose purpose, int fewest) {
  if (comm.size() < fewest) return exchange(comm, std::move(outgoing), purpose);
  std::vector<Parcel> onward = down_the_column(exchange(comm, along_the_row(comm, std::move(outgoing)), purpose));
  const std::vector<Parcel> arrived = exchange(comm, std::move(onward), purpose);
  std::vector<Parcel> incoming;
  for_each_parcel(arrived, [&](const Label& label, std::span<const std::byte> bytes) {
    incoming.push_back({label.from, {bytes.begin(), bytes.end()}});
  });
  std::ranges::sort(incoming, {}, &Parcel::rank);
  return incoming;
}

}  // namespace packmpi::comm
