#include "neighbor/halo.hpp"

#include <petscsf.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <span>
#include <string>

#include "base/grow.hpp"
#include "comm/datatype.hpp"
#include "comm/petsc.hpp"
#include "neighbor/wire.hpp"

namespace packmpi::neighbor {
namespace {

void check(PetscErrorCode code) { comm::check_petsc(code, "exchange ghosts"); }

// What travels at a rebuild before the particles, whose first `early` are of the first half.
struct Heading {
  std::array<std::int64_t, 2> first_root;  // where the sender keeps the first of them in its send buffers
  std::int64_t early;
};

std::vector<std::byte> pack(const particles::Store& store, std::span<const LocalIndex> slots, const Heading& heading) {
  std::vector<std::byte> bytes(sizeof heading);
  bytes.reserve(sizeof heading + slots.size() * wire_bytes(store.layout()));
  std::memcpy(bytes.data(), &heading, sizeof heading);
  for (const LocalIndex slot : slots) put_particle(store, slot, bytes);
  return bytes;
}

// The live doubles of a record: position, velocity, spin are each contiguous in it.
void gather_live(const particles::Layout& layout, const double* record, double* out) {
  const auto dim = static_cast<std::size_t>(layout.dimension);
  std::copy_n(record + layout.position, dim, out);
  std::copy_n(record + layout.velocity, dim, out + dim);
  if (layout.rotation)
    std::copy_n(record + layout.spin, static_cast<std::size_t>(layout.spin_components()), out + 2 * dim);
}

void scatter_live(const particles::Layout& layout, const double* in, double* record) {
  const auto dim = static_cast<std::size_t>(layout.dimension);
  std::copy_n(in, dim, record + layout.position);
  std::copy_n(in + dim, dim, record + layout.velocity);
  if (layout.rotation)
    std::copy_n(in + 2 * dim, static_cast<std::size_t>(layout.spin_components()), record + layout.spin);
}

}  // namespace

class Halo::Unit {
 public:
  explicit Unit(int live_doubles) : type_(comm::double_block(live_doubles)) {}
  ~Unit() { comm::free_type(type_); }
  Unit(const Unit&) = delete;
  Unit& operator=(const Unit&) = delete;
  [[nodiscard]] MPI_Datatype type() const noexcept { return type_; }

 private:
  MPI_Datatype type_;
};

class Halo::Graph {
 public:
  // Collective. Leaf k is root origin[k]. Nothing is sent before this rank's first leaf.
  Graph(const comm::Comm& comm, std::size_t roots, std::vector<PetscSFNode>& origin) {
    check(PetscSFCreate(comm.handle(), &sf_));
    check(PetscSFSetGraph(sf_, static_cast<PetscInt>(roots), static_cast<PetscInt>(origin.size()), nullptr,
                          PETSC_OWN_POINTER, origin.data(), PETSC_COPY_VALUES));
    check(PetscSFSetUp(sf_));
  }
  ~Graph() { PetscSFDestroy(&sf_); }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;
  void begin(MPI_Datatype unit, const void* roots, void* leaves) const {
    check(PetscSFBcastBegin(sf_, unit, roots, leaves, MPI_REPLACE));
  }
  void end(MPI_Datatype unit, const void* roots, void* leaves) const {
    check(PetscSFBcastEnd(sf_, unit, roots, leaves, MPI_REPLACE));
  }

 private:
  PetscSF sf_ = nullptr;
};

Halo::Halo(const comm::Comm& comm, const particles::Layout& layout)
    : comm_(&comm), layout_(layout), unit_(std::make_unique<Unit>(layout.live_doubles())) {}

// An error between begin() and end() unwinds past messages that may still arrive: what they are written into lives as
// long as the process, which that error ends.
Halo::~Halo() {
  static std::vector<std::vector<double>> abandoned;
  for (Part& part : parts_) {
    if (part.under_way) abandoned.push_back(std::move(part.receive_buffer));
  }
}

void Halo::plan(particles::Store& store, const std::vector<Sends>& sends) {
  assert(!under_way(Half::first) && !under_way(Half::second));
  store.set_ghosts(0);
  if (comm_->size() == 1) return;
  for (Part& part : parts_) part.send_slot.clear(), part.messages = 0;
  std::vector<comm::Parcel> outgoing;
  for (const Sends& to : sends) {
    const auto split = std::ranges::lower_bound(to.slots, store.owned() / 2);
    Heading heading{{}, split - to.slots.begin()};
    for (const Half half : halves) {
      Part& mine = part(half);
      heading.first_root[static_cast<std::size_t>(half)] = std::ssize(mine.send_slot);
      const auto from = half == Half::first ? to.slots.begin() : split;
      const auto until = half == Half::first ? split : to.slots.end();
      mine.send_slot.insert(mine.send_slot.end(), from, until);
      mine.messages += from < until ? 1 : 0;
    }
    outgoing.push_back({to.rank, pack(store, to.slots, heading)});
  }
  const std::vector<comm::Parcel> incoming = comm::exchange(*comm_, std::move(outgoing), comm::Purpose::halo);

  for (Part& part : parts_) part.arrival_slot.clear();
  std::array<std::vector<PetscSFNode>, 2> origin;  // where each ghost lives: rank and place in its send buffer
  for (const comm::Parcel& parcel : incoming) {
    Heading heading{};
    std::memcpy(&heading, parcel.bytes.data(), sizeof heading);
    const std::span particles = std::span(parcel.bytes).subspan(sizeof heading);
    const std::size_t each = wire_bytes(layout_);
    const auto count = static_cast<std::int64_t>(particles.size() / each);
    const LocalIndex slot = store.total();
    store.set_ghosts(store.ghosts() + static_cast<LocalIndex>(count));
    for (std::int64_t k = 0; k < count; ++k) {
      const std::size_t half = k < heading.early ? 0 : 1;
      const std::int64_t root = heading.first_root[half] + (half == 0 ? k : k - heading.early);
      origin[half].push_back({parcel.rank, static_cast<PetscInt>(root)});
      const LocalIndex ghost = slot + static_cast<LocalIndex>(k);
      take_particle(particles.data() + static_cast<std::size_t>(k) * each, store, ghost);
      parts_[half].arrival_slot.push_back(ghost);
    }
  }

  const auto live = static_cast<std::size_t>(layout_.live_doubles());
  for (const Half half : halves) {
    Part& mine = part(half);
    std::vector<PetscSFNode>& from = origin[static_cast<std::size_t>(half)];
    mine.graph = std::make_unique<Graph>(*comm_, mine.send_slot.size(), from);
    comm::Traffic setup;  // what PetscSFSetUp sends: to each origin how many ghosts, then which
    for (std::size_t k = 0; k < from.size(); ++k) {
      if (k == 0 || from[k].rank != from[k - 1].rank) {
        setup.messages += 2;
        setup.bytes += static_cast<std::int64_t>(sizeof(PetscInt));
      }
      setup.bytes += static_cast<std::int64_t>(sizeof(PetscInt));
    }
    comm_->count(comm::Purpose::halo, setup);
    resize_tightly(mine.send_buffer, mine.send_slot.size() * live);
    resize_tightly(mine.receive_buffer, from.size() * live);
  }
}

void Halo::order_ghosts(particles::Store& store, const std::vector<LocalIndex>& place) {
  const auto ghosts = static_cast<std::size_t>(store.ghosts());
  const auto stride = static_cast<std::size_t>(layout_.stride);
  const double* first = store.record(store.owned());
  const std::vector<double> records(first, first + ghosts * stride);
  const std::vector<GlobalId> ids(store.ids().end() - store.ghosts(), store.ids().end());
  for (std::size_t k = 0; k < ghosts; ++k) {
    const LocalIndex slot = store.owned() + place[k];
    std::copy_n(records.data() + k * stride, stride, store.record(slot));
    store.ids()[static_cast<std::size_t>(slot)] = ids[k];
  }
  for (Part& part : parts_) {
    for (LocalIndex& slot : part.arrival_slot) {
      slot = store.owned() + place[static_cast<std::size_t>(slot - store.owned())];
    }
  }
}

void Halo::begin(Half half, const particles::Store& store) {
  if (comm_->size() == 1) return;
  Part& mine = part(half);
  assert(!mine.under_way);
  const auto live = static_cast<std::size_t>(layout_.live_doubles());
  for (std::size_t k = 0; k < mine.send_slot.size(); ++k) {
    gather_live(layout_, store.record(mine.send_slot[k]), mine.send_buffer.data() + k * live);
  }
  mine.graph->begin(unit_->type(), mine.send_buffer.data(), mine.receive_buffer.data());
  mine.under_way = true;
  comm_->count(comm::Purpose::ghosts,
               {mine.messages, static_cast<std::int64_t>(mine.send_buffer.size() * sizeof(double))});
}

void Halo::end(Half half, particles::Store& store) {
  Part& mine = part(half);
  if (!mine.under_way) return;
  mine.graph->end(unit_->type(), mine.send_buffer.data(), mine.receive_buffer.data());
  mine.under_way = false;
  const auto live = static_cast<std::size_t>(layout_.live_doubles());
  for (std::size_t k = 0; k < mine.arrival_slot.size(); ++k) {
    scatter_live(layout_, mine.receive_buffer.data() + k * live, store.record(mine.arrival_slot[k]));
  }
}

void Halo::share(std::span<std::int64_t> values) const {
  if (comm_->size() == 1) return;
  for (const Part& part : parts_) {
    std::vector<std::int64_t> out(part.send_slot.size()), in(part.arrival_slot.size());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = values[static_cast<std::size_t>(part.send_slot[k])];
    part.graph->begin(MPI_INT64_T, out.data(), in.data());
    part.graph->end(MPI_INT64_T, out.data(), in.data());
    for (std::size_t k = 0; k < in.size(); ++k) values[static_cast<std::size_t>(part.arrival_slot[k])] = in[k];
    comm_->count(comm::Purpose::other, {part.messages, static_cast<std::int64_t>(out.size() * sizeof(std::int64_t))});
  }
}

LocalIndex Halo::ghosts() const noexcept {
  return static_cast<LocalIndex>(parts_[0].arrival_slot.size() + parts_[1].arrival_slot.size());
}

LocalIndex Halo::ready(Half half) const noexcept {
  const std::vector<LocalIndex>& slots = part(half).send_slot;
  return slots.empty() ? 0 : *std::ranges::max_element(slots) + 1;
}

std::size_t Halo::bytes() const noexcept {
  std::size_t total = 0;
  for (const Part& part : parts_) {
    total += (part.send_buffer.capacity() + part.receive_buffer.capacity()) * sizeof(double) +
             (part.send_slot.capacity() + part.arrival_slot.capacity()) * sizeof(LocalIndex);
  }
  return total;
}

}  // namespace packmpi::neighbor
