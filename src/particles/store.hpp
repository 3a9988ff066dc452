/// The particles of one rank: records and ids, owned first, then ghosts.
#pragma once
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/types.hpp"
#include "particles/layout.hpp"

namespace packmpi::particles {

/// A growing array of doubles, aligned to 64 bytes and followed by 64 readable bytes of padding, so that vector loads
/// of the last record stay inside. New elements are not initialised.
class AlignedDoubles {
 public:
  AlignedDoubles() = default;
  AlignedDoubles(AlignedDoubles&& other) noexcept { swap(other); }
  AlignedDoubles& operator=(AlignedDoubles&& other) noexcept {
    AlignedDoubles(std::move(other)).swap(*this);
    return *this;
  }
  void swap(AlignedDoubles& other) noexcept;
  [[nodiscard]] double* data() noexcept { return data_; }
  [[nodiscard]] const double* data() const noexcept { return data_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] std::size_t bytes() const noexcept;  ///< allocated, padding included
  /// Keeps the contents; grows by a tenth more than needed, where it is if the system can: large arrays are not held
  /// twice. Errors: OutOfMemory
  void resize(std::size_t size);
  void give_back_rest();  ///< What is allocated beyond the size.

 private:
  void allocate(std::size_t capacity);
  struct Free {
    void operator()(std::byte* p) const noexcept { std::free(p); }
  };
  std::unique_ptr<std::byte, Free> block_;
  double* data_ = nullptr;  // the first aligned place in it
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// What a particle of several components is made of.
struct Substance {
  double code = 0.0;          ///< of its component, see scene/mixture.hpp
  double inverse_mass = 0.0;  ///< [1/kg]
};

/// Owned particles in slots [0, owned()), ghosts in [owned(), owned() + ghosts()).
/// A ghost carries its owner's bits. Local: no MPI.
class Store {
 public:
  explicit Store(const Layout& layout) : layout_(layout) {}

  [[nodiscard]] const Layout& layout() const noexcept { return layout_; }
  [[nodiscard]] LocalIndex owned() const noexcept { return owned_; }
  [[nodiscard]] LocalIndex ghosts() const noexcept { return ghosts_; }
  [[nodiscard]] LocalIndex total() const noexcept { return owned_ + ghosts_; }

  [[nodiscard]] double* records() noexcept { return records_.data(); }
  [[nodiscard]] const double* records() const noexcept { return records_.data(); }
  [[nodiscard]] double* record(LocalIndex i) noexcept { return records_.data() + offset(i); }
  [[nodiscard]] const double* record(LocalIndex i) const noexcept { return records_.data() + offset(i); }
  [[nodiscard]] Vec3 position(LocalIndex i) const noexcept {  ///< [m]; z = 0 in 2D
    const double* p = record(i) + layout_.position;
    return {p[0], p[1], layout_.dimension == 3 ? p[2] : 0.0};
  }
  [[nodiscard]] Vec3 velocity(LocalIndex i) const noexcept {  ///< [m/s]
    const double* v = record(i) + layout_.velocity;
    return {v[0], v[1], layout_.dimension == 3 ? v[2] : 0.0};
  }
  [[nodiscard]] Vec3 spin(LocalIndex i) const noexcept;  ///< omega [rad/s]; 0 when rotation is off; in 2D (0, 0, omega)
  [[nodiscard]] double radius(LocalIndex i) const noexcept { return record(i)[layout_.radius]; }  ///< [m]
  /// Of layouts that have it.
  [[nodiscard]] Substance substance(LocalIndex i) const noexcept {
    const double* c = record(i) + layout_.component;
    return {c[0], c[1]};
  }
  void set_substance(LocalIndex i, const Substance& made_of) noexcept {
    double* c = record(i) + layout_.component;
    c[0] = made_of.code, c[1] = made_of.inverse_mass, c[2] = c[3] = 0.0;
  }
  [[nodiscard]] std::span<GlobalId> ids() noexcept { return ids_; }  ///< length total()
  [[nodiscard]] std::span<const GlobalId> ids() const noexcept { return ids_; }

  /// Append an owned particle. Precondition: ghosts() == 0. omega [rad/s] is ignored when rotation is off, what it is
  /// made of when all are made of one material.
  void add(GlobalId id, const Vec3& position, double radius, const Vec3& velocity, const Vec3& omega,
           const Substance& made_of = {});
  /// Append an owned particle as it stands in another store of the same layout. Precondition: ghosts() == 0.
  void add_record(GlobalId id, const double* record);
  /// Make room for `count` ghosts; their contents are not set.
  void set_ghosts(LocalIndex count);
  /// Keep the owned particles in the slots `kept` (ascending) and drop the others and all ghosts. In place.
  void keep(std::span<const LocalIndex> kept);
  /// Keep the first `count` owned particles and drop the others and all ghosts. Precondition: count <= owned().
  void keep_first(LocalIndex count);
  /// Put the owned particles into the order order[0], order[1], ... (each slot once) and drop all ghosts. In place, so
  /// that no second copy of the particles is ever held; `order` is used up. Cost: one pass over the records.
  void permute(std::span<LocalIndex> order);
  /// Gives back the memory allocated beyond what is there.
  void give_back_rest();
  /// Bytes allocated for the particles.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  [[nodiscard]] std::size_t offset(LocalIndex i) const noexcept {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(layout_.stride);
  }
  Layout layout_;
  LocalIndex owned_ = 0;
  LocalIndex ghosts_ = 0;
  AlignedDoubles records_;
  std::vector<GlobalId> ids_;
};

/// A number that names the state of the owned particles: the sum mod 2^64 over them of a hash of id and the bits of the
/// record's fields (not its padding). Independent of order; add it over the ranks (comm.sum) and it is independent of
/// them too. Local.
[[nodiscard]] std::uint64_t digest(const Store& store);

}  // namespace packmpi::particles
