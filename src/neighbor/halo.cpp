#include "neighbor/halo.hpp"

#include <petscsf.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "base/grow.hpp"
#include "comm/datatype.hpp"

namespace packmpi::neighbor {
namespace {

void check(PetscErrorCode code) {
  if (code != 0)
    throw Error(ExitCode::io_failure, "PETSc could not exchange ghosts (error " + std::to_string(code) + ")");
}

// What travels at a rebuild: where the sender keeps the first of these in its send buffer, then ids, then records.
std::vector<std::byte> pack(const particles::Store& store, std::span<const LocalIndex> slots, std::int64_t first_root) {
  const std::size_t record = store.layout().record_bytes();
  std::vector<std::byte> bytes(sizeof first_root + slots.size() * (sizeof(GlobalId) + record));
  std::byte* out = bytes.data();
  std::memcpy(out, &first_root, sizeof first_root);
  out += sizeof first_root;
  for (const LocalIndex slot : slots) {
    std::memcpy(out, &store.ids()[static_cast<std::size_t>(slot)], sizeof(GlobalId));
    out += sizeof(GlobalId);
    std::memcpy(out, store.record(slot), record);
    out += record;
  }
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

struct Halo::Graph {
  PetscSF sf = nullptr;
  MPI_Datatype unit = MPI_DATATYPE_NULL;

  explicit Graph(int live_doubles) : unit(comm::double_block(live_doubles)) {}
  ~Graph() {
    reset();
    comm::free_type(unit);
  }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;
  void reset() {
    if (sf != nullptr) PetscSFDestroy(&sf);
  }
};

Halo::Halo(const comm::Comm& comm, const particles::Layout& layout)
    : comm_(&comm), layout_(layout), graph_(std::make_unique<Graph>(layout.live_doubles())) {}

Halo::~Halo() = default;

void Halo::plan(particles::Store& store, std::vector<Sends> sends) {
  store.set_ghosts(0);
  if (comm_->size() == 1) return;
  send_slots_.clear();
  std::vector<comm::Parcel> outgoing;
  for (const Sends& to : sends) {
    outgoing.push_back({to.rank, pack(store, to.slots, static_cast<std::int64_t>(send_slots_.size()))});
    send_slots_.insert(send_slots_.end(), to.slots.begin(), to.slots.end());
  }
  messages_per_refresh_ = std::ranges::count_if(sends, [](const Sends& to) { return !to.slots.empty(); });
  const std::vector<comm::Parcel> incoming = comm::exchange(*comm_, std::move(outgoing), comm::Purpose::halo);

  const std::size_t record = layout_.record_bytes();
  comm::Traffic setup;              // what PetscSFSetUp sends: to each origin how many ghosts, then which
  std::vector<PetscSFNode> origin;  // where each ghost lives: rank and place in that rank's send buffer
  for (const comm::Parcel& parcel : incoming) {
    std::int64_t first_root = 0;
    std::memcpy(&first_root, parcel.bytes.data(), sizeof first_root);
    const std::size_t count = (parcel.bytes.size() - sizeof first_root) / (sizeof(GlobalId) + record);
    const auto before = static_cast<LocalIndex>(origin.size());
    store.set_ghosts(before + static_cast<LocalIndex>(count));
    if (count > 0) {
      setup.messages += 2;
      setup.bytes += static_cast<std::int64_t>((1 + count) * sizeof(PetscInt));
    }
    const std::byte* in = parcel.bytes.data() + sizeof first_root;
    for (std::size_t k = 0; k < count; ++k) {
      const LocalIndex slot = store.owned() + before + static_cast<LocalIndex>(k);
      std::memcpy(&store.ids()[static_cast<std::size_t>(slot)], in, sizeof(GlobalId));
      std::memcpy(store.record(slot), in + sizeof(GlobalId), record);
      in += sizeof(GlobalId) + record;
      origin.push_back({parcel.rank, static_cast<PetscInt>(first_root + static_cast<std::int64_t>(k))});
    }
  }

  graph_->reset();
  check(PetscSFCreate(comm_->handle(), &graph_->sf));
  check(PetscSFSetGraph(graph_->sf, static_cast<PetscInt>(send_slots_.size()), static_cast<PetscInt>(origin.size()),
                        nullptr, PETSC_OWN_POINTER, origin.data(), PETSC_COPY_VALUES));
  check(PetscSFSetUp(graph_->sf));
  comm_->count(comm::Purpose::halo, setup);
  const auto live = static_cast<std::size_t>(layout_.live_doubles());
  resize_tightly(send_buffer_, send_slots_.size() * live);
  resize_tightly(receive_buffer_, origin.size() * live);
  resize_tightly(arrival_slot_, origin.size());
  for (std::size_t k = 0; k < origin.size(); ++k) arrival_slot_[k] = store.owned() + static_cast<LocalIndex>(k);
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
    arrival_slot_[k] = slot;
  }
}

void Halo::refresh(particles::Store& store) {
  if (comm_->size() == 1) return;
  const auto live = static_cast<std::size_t>(layout_.live_doubles());
  for (std::size_t k = 0; k < send_slots_.size(); ++k) {
    gather_live(layout_, store.record(send_slots_[k]), send_buffer_.data() + k * live);
  }
  check(PetscSFBcastBegin(graph_->sf, graph_->unit, send_buffer_.data(), receive_buffer_.data(), MPI_REPLACE));
  check(PetscSFBcastEnd(graph_->sf, graph_->unit, send_buffer_.data(), receive_buffer_.data(), MPI_REPLACE));
  for (std::size_t k = 0; k < arrival_slot_.size(); ++k) {
    scatter_live(layout_, receive_buffer_.data() + k * live, store.record(arrival_slot_[k]));
  }
  comm_->count(comm::Purpose::ghosts,
               {messages_per_refresh_, static_cast<std::int64_t>(send_buffer_.size() * sizeof(double))});
}

void Halo::share(std::span<std::int64_t> values) const {
  if (comm_->size() == 1) return;
  std::vector<std::int64_t> out(send_slots_.size()), in(arrival_slot_.size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = values[static_cast<std::size_t>(send_slots_[k])];
  check(PetscSFBcastBegin(graph_->sf, MPI_INT64_T, out.data(), in.data(), MPI_REPLACE));
  check(PetscSFBcastEnd(graph_->sf, MPI_INT64_T, out.data(), in.data(), MPI_REPLACE));
  for (std::size_t k = 0; k < in.size(); ++k) values[static_cast<std::size_t>(arrival_slot_[k])] = in[k];
  comm_->count(comm::Purpose::ghosts,
               {messages_per_refresh_, static_cast<std::int64_t>(out.size() * sizeof(std::int64_t))});
}

std::size_t Halo::bytes() const noexcept {
  return (send_buffer_.capacity() + receive_buffer_.capacity()) * sizeof(double) +
         (send_slots_.capacity() + arrival_slot_.capacity()) * sizeof(LocalIndex);
}

}  // namespace packmpi::neighbor
