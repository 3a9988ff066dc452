#include "neighbor/baggage.hpp"

#include <cstring>

#include "base/release.hpp"

namespace packmpi::neighbor {

void Baggage::clear() {
  head_.clear();
  size_ = 0;
}

void Baggage::release() {
  clear();
  packmpi::release(head_);
  packmpi::release(pieces_);
}

void Baggage::add(LocalIndex slot, GlobalId partner, const double* values, std::size_t step, const double* signs) {
  std::int64_t& head = head_[static_cast<std::size_t>(slot)];
  if (size_ == pieces_.size() * piece) pieces_.push_back(std::make_unique_for_overwrite<double[]>(piece * each_));
  const auto at = static_cast<std::int64_t>(size_++);
  double* out = item(at);
  *out++ = std::bit_cast<double>(partner);
  *out++ = std::bit_cast<double>(head);
  for (std::size_t c = 0; c < doubles_; ++c) *out++ = signs[c] * values[c * step];
  head = at;
}

void Baggage::keep(std::span<const LocalIndex> kept) {
  const std::vector<std::int64_t> before = std::move(head_);
  head_.assign(kept.size(), none);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto slot = static_cast<std::size_t>(kept[k]);
    if (slot < before.size()) head_[k] = before[slot];
  }
}

void Baggage::permute(std::span<const LocalIndex> order) { keep(order); }

void Baggage::write(LocalIndex slot, std::vector<std::byte>& out) const {
  const auto put = [&out](const void* from, std::size_t bytes) {
    const auto* begin = static_cast<const std::byte*>(from);
    out.insert(out.end(), begin, begin + bytes);
  };
  const std::size_t at = out.size();
  std::uint64_t count = 0;
  put(&count, sizeof count);
  each(slot, [&](const Item& item) {
    put(&item.partner, sizeof item.partner);
    put(item.values.data(), item.values.size_bytes());
    ++count;
  });
  std::memcpy(out.data() + at, &count, sizeof count);
}

std::size_t Baggage::read(std::span<const std::byte> in) {
  const std::byte* from = in.data();
  const auto get = [&from](void* to, std::size_t bytes) {
    std::memcpy(to, from, bytes);
    from += bytes;
  };
  fit(static_cast<LocalIndex>(head_.size()) + 1);
  std::vector<double> values(doubles_);
  std::uint64_t count = 0;
  get(&count, sizeof count);
  for (std::uint64_t k = 0; k < count; ++k) {
    GlobalId partner = 0;
    get(&partner, sizeof partner);
    get(values.data(), doubles_ * sizeof(double));
    add(static_cast<LocalIndex>(head_.size()) - 1, partner, values.data(), 1, as_they_are_.data());
  }
  return static_cast<std::size_t>(from - in.data());
}

}  // namespace packmpi::neighbor
