/// Items for other ranks, collected one by one and sent as one parcel each.
#pragma once
#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "comm/comm.hpp"

namespace packmpi::rsa {

/// Items of one plain type, posted to ranks and delivered together. Memory: O(items).
template <class Item>
class Mailbox {
  static_assert(std::is_trivially_copyable_v<Item>);

 public:
  void post(Rank to, const Item& item) {
    order_.emplace_back(to, items_.size());
    items_.push_back(item);
  }
  [[nodiscard]] std::size_t size() const noexcept { return items_.size(); }

  /// Collective. Sends what was posted, and returns what others posted to this rank: by source rank, then in order of
  /// posting.
  [[nodiscard]] std::vector<Item> deliver(const comm::Comm& comm) {
    std::vector<Item> received;
    if (comm.size() == 1) return received;  // nobody else to hear from
    for (const comm::Parcel& parcel : comm::relay(comm, pack(), comm::Purpose::insertion)) {
      const std::size_t old = received.size();
      received.resize(old + parcel.bytes.size() / sizeof(Item));
      std::memcpy(received.data() + old, parcel.bytes.data(), parcel.bytes.size());
    }
    return received;
  }

 private:
  std::vector<comm::Parcel> pack() {
    std::ranges::sort(order_);
    std::vector<comm::Parcel> parcels;
    for (std::size_t begin = 0, end = 0; begin < order_.size(); begin = end) {
      while (end < order_.size() && order_[end].first == order_[begin].first) ++end;
      comm::Parcel& parcel = parcels.emplace_back(comm::Parcel{order_[begin].first, {}});
      parcel.bytes.resize((end - begin) * sizeof(Item));
      for (std::size_t k = begin; k < end; ++k) {
        std::memcpy(parcel.bytes.data() + (k - begin) * sizeof(Item), &items_[order_[k].second], sizeof(Item));
      }
    }
    order_.clear();
    items_.clear();
    return parcels;
  }

  std::vector<std::pair<Rank, std::size_t>> order_;
  std::vector<Item> items_;
};

}  // namespace packmpi::rsa
