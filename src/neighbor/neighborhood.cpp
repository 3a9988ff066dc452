#include "neighbor/neighborhood.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "base/grow.hpp"
#include "base/memory.hpp"
#include "base/timer.hpp"
#include "neighbor/wire.hpp"
#include "scene/limits.hpp"
#include "scene/pair_channels.hpp"

namespace packmpi::neighbor {
namespace {

// Lists live on after true displacements were looked at if they need not be looked at again for so many steps.
constexpr double live_on = 2.0;
// No particle of a valid run is this many container heights up.
constexpr double highest = 1000.0;

// Sets the levels of cells up to `top`, as high as lists reach. One cell holds all above the highest place of a
// valid run, so that a particle flung up costs no memory. Where there would be far more cells than particles they are
// higher, which also keeps their number in a LocalIndex.
void set_levels(Cells& cells, double top, const scene::Scene& scene, int columns, LocalIndex owned) {
  constexpr double always = 0x1p22, a_particle = 64.0;
  const double most = static_cast<double>(scene::most_layers(scene) + 1) * scene.in.layers.thickness;
  const double height = std::max(std::min(top, most) - cells.bottom, 0.0);
  const double affordable =
      std::min(std::max(always, a_particle * owned), double{std::numeric_limits<LocalIndex>::max() - 1});
  const double levels = std::max(affordable / std::max(columns, 1) - 1.0, 0.0);
  const double wanted = height / scene.list_range();
  cells.inverse_height = wanted <= levels ? 1.0 / scene.list_range() : levels / height;
  cells.levels = static_cast<int>(std::min(wanted, levels)) + 1;
}

}  // namespace

Neighborhood::Neighborhood(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership)
    : comm_(&comm),
      scene_(&scene),
      ownership_(&ownership),
      columns_(ownership, comm.rank()),
      frozen_(comm, scene.features.layout(), scene::stored_doubles(scene.features)),
      halo_(comm, scene.features.layout()),
      size_classes_(scene, ownership),
      memory_(scene.features),
      margins_(scene) {}

void Neighborhood::ownership_changed() {
  columns_ = LocalColumns(*ownership_, comm_->rank());
  frozen_arranged_ = !frozen_.in_use();
}

void Neighborhood::freeze(particles::Store& store, GlobalId below) {
  memory_.pick_up_by_id(store, pairs_, walls_);
  frozen_.take(store, below, memory_.in_use() ? &memory_.baggage() : nullptr);
  frozen_arranged_ = false;
  one_sided_ = memory_.in_use();
}

void Neighborhood::release(particles::Store& store) {
  memory_.pick_up_by_id(store, pairs_, walls_);
  frozen_.give_back(store, memory_.in_use() ? &memory_.baggage() : nullptr);
  one_sided_ = memory_.in_use();
  frozen_cells_ = {};
  frozen_arranged_ = true;
}

void Neighborhood::rebuild(particles::Store& store) {
  const Occupation now("the neighbour lists");
  const Stopwatch watch;
  store.set_ghosts(0);
  const std::vector<Rank> destination = destinations(store);
  memory_.pick_up(store, pairs_, walls_, destination);
  migrate(store, destination, memory_.in_use() ? &memory_.baggage() : nullptr, comm::Purpose::migration);
  sort_owned(store);
  halo_.plan(store, choose_sends(store));
  sort_ghosts(store);
  if (frozen_.in_use()) add_frozen(store);
  remember_positions(store);
  if (scene_->features.size_levels > 1) {
    size_classes_.build({x_[0], x_[1], x_[2], extent_, store.owned()}, pairs_);
    candidates_ = size_classes_.candidates();
  } else {
    build_pairs(store, std::nullopt, pairs_);
  }
  if (scene_->in.near_field) build_pairs(store, scene_->in.near_field->cutoff, near_pairs_);
  build_walls(store);
  memory_.lay_down(store, pairs_, walls_);
  if (one_sided_) complete_borders(store);
  face_walls(store);
  sweep_ = make_sweep(store.owned(), pairs_, walls_, halo_);
  slack_ = least_slack(store);
  drift_ = 0.0;
  strained_ = 0.0;
  ++effort_.rebuilds;
  effort_.candidates += candidates_;
  effort_.rebuilding += watch.seconds();
}

void Neighborhood::begin_refresh(Half half, const particles::Store& store) {
  if (comm_->size() == 1) return;
  const Stopwatch watch;
  halo_.begin(half, store);
  effort_.refreshing += watch.seconds();
}

void Neighborhood::end_refresh(Half half, particles::Store& store) {
  if (!halo_.under_way(half)) return;
  const Stopwatch watch;
  halo_.end(half, store);
  effort_.refreshing += watch.seconds();
}

void Neighborhood::begin_missing(const particles::Store& store) {
  for (const Half half : halves) {
    if (!halo_.under_way(half)) begin_refresh(half, store);
  }
}

void Neighborhood::arrive(particles::Store& store) {
  for (const Half half : halves) end_refresh(half, store);
}

void Neighborhood::refresh_ghosts(particles::Store& store) {
  begin_missing(store);
  arrive(store);
}

void Neighborhood::meet(std::array<double, 2>& shared) {
  if (comm_->size() == 1) return comm_->max(shared);
  const Stopwatch watch;
  comm_->max(shared);
  effort_.waiting += watch.seconds();
}

Alarm Neighborhood::follow(particles::Store& store, double max_speed, double time_step, Alarm mine) {
  const double way = max_speed * time_step;
  time_step_ = time_step;
  face_walls(store);
  drift_ += way;
  if (!std::isfinite(drift_)) mine = Alarm::fault;
  std::array<double, 2> shared{mine == Alarm::fault ? 0.0 : drift_ - slack_, static_cast<double>(mine)};
  meet(shared);
  const auto alarm = static_cast<Alarm>(static_cast<int>(shared[1]));
  begin_missing(store);
  if (alarm == Alarm::fault || shared[0] + strained_ <= 0.0) return alarm;
  slack_ = least_slack(store);
  drift_ = 0.0;
  std::array<double, 2> worst{-slack_, way};
  comm_->max(worst);
  if (worst[0] + strained_ + live_on * worst[1] <= 0.0) return alarm;
  bool all_inside = true;
  for (LocalIndex i = 0; i < store.owned() && all_inside; ++i) all_inside = is_inside(store, i);
  if (comm_->max(std::int64_t{all_inside ? 0 : 1}) > 0) return Alarm::fault;
  arrive(store);
  rebuild(store);
  return alarm;
}

bool Neighborhood::is_inside(const particles::Store& store, LocalIndex i) const {
  const geometry::Container& box = scene_->container;
  const Vec3 x = store.position(i);
  const double z = x[static_cast<std::size_t>(box.vertical())];
  if (box.is_mesh()) {
    const bool under_lid = !box.lid || z < *box.lid + store.radius(i);
    return norm(x) < HUGE_VAL && under_lid && !box.interior->surely_outside(x);
  }
  return box.beyond(x) < store.radius(i) && z < highest * (box.height() + scene_->in.layers.thickness);
}

// Where each owned particle belongs now; empty on a single rank.
std::vector<Rank> Neighborhood::destinations(const particles::Store& store) const {
  std::vector<Rank> ranks;
  if (comm_->size() == 1) return ranks;
  ranks.reserve(static_cast<std::size_t>(store.owned()));
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    ranks.push_back(ownership_->owner(ownership_->grid().column(store.position(i))));
  }
  return ranks;
}

void Neighborhood::migrate(particles::Store& store, std::span<const Rank> destination, Baggage* baggage,
                           comm::Purpose purpose) const {
  if (comm_->size() == 1) return;
  std::vector<comm::Parcel> outgoing;
  std::vector<LocalIndex> staying;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Rank owner = destination[static_cast<std::size_t>(i)];
    if (owner == comm_->rank()) {
      staying.push_back(i);
      continue;
    }
    std::vector<std::byte>& bytes = bytes_for(owner, outgoing);
    put_particle(store, i, bytes);
    if (baggage != nullptr) baggage->write(i, bytes);
  }
  const std::vector<comm::Parcel> incoming = comm::exchange(*comm_, std::move(outgoing), purpose);
  if (baggage != nullptr) baggage->keep(staying);
  if (staying.size() < static_cast<std::size_t>(store.owned())) store.keep(staying);
  for (const comm::Parcel& parcel : incoming) {
    for (std::size_t at = 0; at < parcel.bytes.size();) {
      add_particle(parcel.bytes.data() + at, store);
      at += wire_bytes(store.layout());
      if (baggage != nullptr) at += baggage->read(std::span(parcel.bytes).subspan(at));
    }
  }
}

// Collective. Where a contact had been at one of its owners only, the other gets its copy.
void Neighborhood::complete_borders(const particles::Store& store) {
  one_sided_ = false;
  if (comm_->size() == 1) return;
  std::vector<comm::Parcel> outgoing;
  const auto put = [](std::vector<std::byte>& out, const void* from, std::size_t bytes) {
    const auto* begin = static_cast<const std::byte*>(from);
    out.insert(out.end(), begin, begin + bytes);
  };
  memory_.each_border(store, pairs_, store.owned() + halo_.ghosts(),
                      [&](LocalIndex ghost, GlobalId theirs, GlobalId mine, std::span<const double> values) {
                        const Rank owner = ownership_->owner(ownership_->grid().column(store.position(ghost)));
                        std::vector<std::byte>& bytes = bytes_for(owner, outgoing);
                        put(bytes, &theirs, sizeof theirs);
                        put(bytes, &mine, sizeof mine);
                        put(bytes, values.data(), values.size_bytes());
                      });
  const std::vector<comm::Parcel> incoming = comm::exchange(*comm_, std::move(outgoing), comm::Purpose::migration);
  std::vector<std::pair<GlobalId, LocalIndex>> slots;
  slots.reserve(static_cast<std::size_t>(store.owned()));
  for (LocalIndex i = 0; i < store.owned(); ++i) slots.emplace_back(store.ids()[static_cast<std::size_t>(i)], i);
  std::ranges::sort(slots);
  std::vector<double> values(memory_.doubles());
  const std::size_t each = 2 * sizeof(GlobalId) + values.size() * sizeof(double);
  for (const comm::Parcel& parcel : incoming) {
    for (std::size_t at = 0; at < parcel.bytes.size(); at += each) {
      std::array<GlobalId, 2> ids{};
      std::memcpy(ids.data(), parcel.bytes.data() + at, sizeof ids);
      std::memcpy(values.data(), parcel.bytes.data() + at + sizeof ids, values.size() * sizeof(double));
      const auto mine = std::ranges::lower_bound(slots, ids[0], {}, &std::pair<GlobalId, LocalIndex>::first);
      memory_.set_border(store, pairs_, mine->second, ids[1], values.data());
    }
  }
}

void Neighborhood::each_history(const particles::Store& store,
                                const std::function<void(const ContactHistory&)>& see) const {
  memory_.each(store, pairs_, walls_, see);
  memory_.each(frozen_.store(), frozen_.baggage(), see);
}

void Neighborhood::give(const particles::Store& store, std::span<const ContactHistory> histories) {
  memory_.give(store, histories);
  one_sided_ = memory_.in_use();
}

void Neighborhood::sort_owned(particles::Store& store) {
  const auto vertical = static_cast<std::size_t>(scene_->container.vertical());
  double top = 0.0;
  double bottom = HUGE_VAL;
  double fastest = 0.0;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double height = store.position(i)[vertical];
    const Vec3 v = store.velocity(i);
    top = std::max(top, height);
    bottom = std::min(bottom, height);
    fastest = std::max(fastest, dot(v, v));
  }
  cells_.bottom = frozen_.in_use() ? std::min(top, bottom) : 0.0;  // nothing is listed far below the moving particles
  std::array<double, 2> most{top, std::sqrt(fastest)};
  comm_->max(most);
  margins_.plan(most[1], time_step_);
  set_levels(cells_, most[0], *scene_, columns_.total(), store.owned());
  const auto levels = static_cast<std::size_t>(cells_.levels);
  cells_.start.assign(static_cast<std::size_t>(columns_.total()) * levels + 1, 0);

  const auto owned = static_cast<std::size_t>(store.owned());
  std::vector<LocalIndex> cell(owned);
  for (std::size_t i = 0; i < owned; ++i) {
    const Vec3 x = store.position(static_cast<LocalIndex>(i));
    const int column = columns_.local(ownership_->grid().column(x));
    cell[i] = static_cast<LocalIndex>(static_cast<std::size_t>(column) * levels) + cells_.level(x[vertical]);
    ++cells_.start[static_cast<std::size_t>(cell[i]) + 1];
  }
  std::partial_sum(cells_.start.begin(), cells_.start.end(), cells_.start.begin());
  std::vector<LocalIndex> next(cells_.start.begin(), cells_.start.end() - 1);
  std::vector<LocalIndex> order(owned);
  for (std::size_t i = 0; i < owned; ++i) {
    order[static_cast<std::size_t>(next[static_cast<std::size_t>(cell[i])]++)] = static_cast<LocalIndex>(i);
  }
  if (memory_.in_use()) memory_.baggage().permute(order);
  store.permute(order);
}

std::vector<Sends> Neighborhood::choose_sends(const particles::Store& store) const {
  std::vector<Sends> sends;
  for (const Rank rank : ownership_->neighbors()) sends.push_back({rank, {}});
  const double range = scene_->list_range() * (1.0 + 1e-12);  // distance() is rounded
  const auto levels = static_cast<std::size_t>(cells_.levels);
  for (const LocalColumns::Border& border : columns_.borders()) {
    std::vector<LocalIndex>& slots = std::ranges::find(sends, border.rank, &Sends::rank)->slots;
    const auto c = static_cast<std::size_t>(border.local);
    for (LocalIndex i = cells_.start[c * levels]; i < cells_.start[(c + 1) * levels]; ++i) {
      const Vec3 x = store.position(i);
      const bool wanted = std::ranges::any_of(
          border.columns, [&](geometry::ColumnIndex column) { return ownership_->grid().distance(x, column) < range; });
      if (wanted) slots.push_back(i);
    }
  }
  return sends;
}

void Neighborhood::sort_ghosts(particles::Store& store) {
  const auto ghosts = static_cast<std::size_t>(store.ghosts());
  const auto vertical = static_cast<std::size_t>(scene_->container.vertical());
  const auto levels = static_cast<std::size_t>(cells_.levels);
  const auto first_cell = static_cast<std::size_t>(columns_.own()) * levels;
  std::vector<std::size_t> cell(ghosts);
  std::vector<LocalIndex> count(cells_.start.size() - first_cell, 0);
  for (std::size_t k = 0; k < ghosts; ++k) {
    const Vec3 x = store.position(store.owned() + static_cast<LocalIndex>(k));
    const int column = columns_.local(ownership_->grid().column(x));
    cell[k] =
        static_cast<std::size_t>(column) * levels + static_cast<std::size_t>(cells_.level(x[vertical])) - first_cell;
    ++count[cell[k] + 1];
  }
  std::partial_sum(count.begin(), count.end(), count.begin());
  for (std::size_t c = 0; c < count.size(); ++c) cells_.start[first_cell + c] = store.owned() + count[c];
  std::vector<LocalIndex> place(ghosts);
  for (std::size_t k = 0; k < ghosts; ++k) place[k] = count[cell[k]]++;
  halo_.order_ghosts(store, place);
}

// Frozen particles that a moving one of the same or a touching column may reach, as ghosts behind the halo's.
void Neighborhood::add_frozen(particles::Store& store) {
  const double range = scene_->list_range() * (1.0 + 1e-12);
  if (!frozen_arranged_) {
    frozen_.store().set_ghosts(0);
    migrate(frozen_.store(), destinations(frozen_.store()), memory_.in_use() ? &frozen_.baggage() : nullptr,
            comm::Purpose::frozen);
    frozen_.arrange(*ownership_, columns_, range);
    frozen_arranged_ = true;
  }
  const auto vertical = static_cast<std::size_t>(scene_->container.vertical());
  std::vector<double> lowest(static_cast<std::size_t>(columns_.total()), HUGE_VAL);
  for (int c = 0; c < columns_.own(); ++c) {
    const auto levels = static_cast<std::size_t>(cells_.levels);
    const auto cell = static_cast<std::size_t>(c) * levels;
    double mine = HUGE_VAL;
    for (LocalIndex i = cells_.start[cell]; i < cells_.start[cell + levels]; ++i) {
      mine = std::min(mine, store.position(i)[vertical] - range);
    }
    const auto lower = [&](int column) {
      lowest[static_cast<std::size_t>(column)] = std::min(lowest[static_cast<std::size_t>(column)], mine);
    };
    lower(c);
    for (const int other : columns_.around(c)) lower(other);
  }
  frozen_cells_.levels = cells_.levels;
  frozen_cells_.bottom = cells_.bottom;
  frozen_cells_.inverse_height = cells_.inverse_height;
  frozen_.append(lowest, store, frozen_cells_);
}

void Neighborhood::remember_positions(const particles::Store& store) {
  const auto total = static_cast<std::size_t>(store.total());
  for (int a = 0; a < scene_->container.dimension; ++a) {
    std::vector<double>& x = x_[static_cast<std::size_t>(a)];
    resize_tightly(x, total);
    for (std::size_t i = 0; i < total; ++i) x[i] = store.record(static_cast<LocalIndex>(i))[a];
  }
  resize_tightly(extent_, total);
  const LocalIndex moving = store.owned() + halo_.ghosts();  // behind them what stands still
  for (std::size_t i = 0; i < total; ++i) {
    const auto slot = static_cast<LocalIndex>(i);
    extent_[i] = store.radius(slot) + (slot < moving ? margins_.of(norm(store.velocity(slot))) : 0.0);
  }
}

void Neighborhood::deform(particles::Store& store, const std::array<double, 2>& factors) {
  const geometry::Container& box = scene_->container;
  for (std::size_t a = 0; a < static_cast<std::size_t>(box.lateral_axes()); ++a) {
    if (!box.periodic[a] || factors[a] == 1.0) continue;
    for (LocalIndex i = 0; i < store.total(); ++i) {
      double& x = store.record(i)[a];
      x = geometry::wrap(x * factors[a], box.size[a]);
    }
    for (double& x : x_[a]) x *= factors[a];
    strained_ += std::abs(factors[a] - 1.0) * scene_->column_width();  // of two that may come to touch
  }
}

// What is left of the margin of that particle which has least; without particles, all there can be.
double Neighborhood::least_slack(const particles::Store& store) const {
  const geometry::Container& box = scene_->container;
  constexpr double hair = 1e-9;  // sums are rounded
  double least = margins_.most();
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double* record = store.record(i);
    double squared = 0.0;
    for (int a = 0; a < box.dimension; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      double d = record[a] - x_[axis][static_cast<std::size_t>(i)];
      if (a < box.lateral_axes() && box.periodic[axis]) d = geometry::shortest(d, box.size[axis]);
      squared += d * d;
    }
    least = std::min(least, extent_[static_cast<std::size_t>(i)] - store.radius(i) - std::sqrt(squared));
  }
  return least - hair * margins_.most();
}

std::vector<std::int64_t> Neighborhood::column_counts(const particles::Store& store) const {
  std::vector<std::int64_t> by_local(static_cast<std::size_t>(columns_.own()), 0);
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const int column = columns_.local(ownership_->grid().column(store.position(i)));
    if (column >= 0 && column < columns_.own()) ++by_local[static_cast<std::size_t>(column)];
  }
  std::vector<std::int64_t> counts;
  for (const geometry::ColumnIndex column : ownership_->columns()) {
    counts.push_back(by_local[static_cast<std::size_t>(columns_.local(column))]);
  }
  return counts;
}

std::size_t Neighborhood::bytes() const noexcept {
  std::size_t total =
      halo_.bytes() + cells_.start.capacity() * sizeof(LocalIndex) + extent_.capacity() * sizeof(double);
  total += frozen_.store().bytes() + frozen_cells_.start.capacity() * sizeof(LocalIndex);
  for (const std::vector<double>& x : x_) total += x.capacity() * sizeof(double);
  for (const PairList* list : {&pairs_, &near_pairs_}) {
    total += (list->first.capacity() + list->second.capacity()) * sizeof(LocalIndex);
  }
  total += memory_.bytes();
  total += walls_.facing.capacity() * sizeof(geometry::Facing);
  total += near_memory_.bytes();
  total += (walls_.near.capacity() + walls_.near_begin.capacity()) * sizeof(std::int32_t);
  return total + walls_.particle.capacity() * (sizeof(LocalIndex) + sizeof(Wall));
}

}  // namespace packmpi::neighbor
