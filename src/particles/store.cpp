#include "particles/store.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "base/grow.hpp"
#include "base/memory.hpp"

namespace packmpi::particles {
namespace {

constexpr std::size_t alignment = 64;                        // bytes
constexpr std::size_t padding = alignment / sizeof(double);  // doubles

std::size_t allocated(std::size_t capacity) { return (capacity + padding) * sizeof(double); }

/// Follows each cycle of the permutation once: `from` moves to `cur`, and so on round. Done slots are marked by
/// order[i] = i. The stride known to the compiler makes each copy a few vector moves.
template <int Stride>
void permute_cycles(std::span<LocalIndex> order, double* records, std::span<GlobalId> ids) {
  const auto at = [records](LocalIndex i) { return records + static_cast<std::ptrdiff_t>(i) * Stride; };
  std::array<double, Stride> first;
  for (std::size_t begin = 0; begin < order.size(); ++begin) {
    auto cur = static_cast<LocalIndex>(begin);
    if (order[begin] == cur) continue;
    std::memcpy(first.data(), at(cur), sizeof first);
    const GlobalId first_id = ids[begin];
    for (;;) {
      const LocalIndex from = std::exchange(order[static_cast<std::size_t>(cur)], cur);
      if (from == static_cast<LocalIndex>(begin)) break;
      std::memcpy(at(cur), at(from), sizeof first);
      ids[static_cast<std::size_t>(cur)] = ids[static_cast<std::size_t>(from)];
      cur = from;
    }
    std::memcpy(at(cur), first.data(), sizeof first);
    ids[static_cast<std::size_t>(cur)] = first_id;
  }
}

void permute_cycles(int stride, std::span<LocalIndex> order, double* records, std::span<GlobalId> ids) {
  switch (stride) {
    case 6:
      return permute_cycles<6>(order, records, ids);
    case 8:
      return permute_cycles<8>(order, records, ids);
    case 12:
      return permute_cycles<12>(order, records, ids);
    case 16:
      return permute_cycles<16>(order, records, ids);
    default:
      assert(false && "a stride that layout_of() never gives");
  }
}

}  // namespace

void AlignedDoubles::swap(AlignedDoubles& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(capacity_, other.capacity_);
}

std::size_t AlignedDoubles::bytes() const noexcept { return data_ ? allocated(capacity_) : 0; }

void AlignedDoubles::resize(std::size_t size) {
  if (size > capacity_) {
    const std::size_t wanted = size + size / 10;
    const std::size_t capacity = (wanted + padding - 1) / padding * padding;  // aligned_alloc takes whole lines
    std::unique_ptr<double, Free> grown(static_cast<double*>(std::aligned_alloc(alignment, allocated(capacity))));
    if (!grown) throw OutOfMemory(allocated(capacity));
    if (size_ > 0) std::memcpy(grown.get(), data_.get(), size_ * sizeof(double));
    data_ = std::move(grown);
    capacity_ = capacity;
  }
  size_ = size;
}

Vec3 Store::spin(LocalIndex i) const noexcept {
  if (!layout_.rotation) return {};
  const double* s = record(i) + layout_.spin;  // surface speeds
  const double r = radius(i);
  if (layout_.dimension == 2) return {0.0, 0.0, s[0] / r};
  return {s[0] / r, s[1] / r, s[2] / r};
}

void Store::add(GlobalId id, const Vec3& position, double radius, const Vec3& velocity, const Vec3& omega,
                const Substance& made_of) {
  std::array<double, 16> fields{};
  const auto put = [&fields](int at, double value) { fields[static_cast<std::size_t>(at)] = value; };
  for (int d = 0; d < layout_.dimension; ++d) {
    put(layout_.position + d, position[static_cast<std::size_t>(d)]);
    put(layout_.velocity + d, velocity[static_cast<std::size_t>(d)]);
  }
  put(layout_.radius, radius);
  put(layout_.curvature, 1.0 / radius);
  for (int c = 0; c < layout_.spin_components(); ++c) {
    put(layout_.spin + c, radius * omega[static_cast<std::size_t>(layout_.dimension == 3 ? c : 2)]);
  }
  if (layout_.component >= 0) {
    put(layout_.component, made_of.code);
    put(layout_.component + 1, made_of.inverse_mass);
  }
  add_record(id, fields.data());
}

void Store::add_record(GlobalId id, const double* record) {
  assert(ghosts_ == 0 && owned_ < std::numeric_limits<LocalIndex>::max());
  const std::size_t at = offset(owned_);
  records_.resize(at + static_cast<std::size_t>(layout_.stride));
  std::memcpy(records_.data() + at, record, layout_.record_bytes());
  ++owned_;
  resize_tightly(ids_, static_cast<std::size_t>(owned_));
  ids_.back() = id;
}

void Store::set_ghosts(LocalIndex count) {
  assert(count >= 0 && count <= std::numeric_limits<LocalIndex>::max() - owned_);
  ghosts_ = count;
  records_.resize(offset(total()));
  resize_tightly(ids_, static_cast<std::size_t>(total()));
}

void Store::keep(std::span<const LocalIndex> kept) {
  assert(std::ranges::is_sorted(kept));
  LocalIndex next = 0;
  for (const LocalIndex from : kept) {
    if (from != next) {
      std::memcpy(record(next), record(from), layout_.record_bytes());
      ids_[static_cast<std::size_t>(next)] = ids_[static_cast<std::size_t>(from)];
    }
    ++next;
  }
  owned_ = next;
  set_ghosts(0);
}

void Store::keep_first(LocalIndex count) {
  assert(count <= owned_);
  owned_ = count;
  set_ghosts(0);
}

void Store::permute(std::span<LocalIndex> order) {
  assert(order.size() == static_cast<std::size_t>(owned_));
  set_ghosts(0);
  permute_cycles(layout_.stride, order, records_.data(), ids_);
}

std::size_t Store::bytes() const noexcept { return records_.bytes() + ids_.capacity() * sizeof(GlobalId); }

}  // namespace packmpi::particles
