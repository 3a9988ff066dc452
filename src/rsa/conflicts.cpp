#include "rsa/conflicts.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

namespace packmpi::rsa {

Conflicts::Outcome Conflicts::resolve(std::span<const Dart> darts, const Volley& volley) {
  own_ = darts.size();
  outcome_ = {};
  first_attempt_ = volley.first;
  darts_.assign(darts.begin(), darts.end());
  announce(volley);
  std::int64_t most_rounds = 1;  // known after the first sum: a round decides one dart at least
  for (std::int64_t round = 0; round < most_rounds; ++round) {
    decide(round == 0);
    std::array<std::int64_t, 5> totals{static_cast<std::int64_t>(open_.size()), static_cast<std::int64_t>(news_.size()),
                                       outcome_.kept, outcome_.thrown, static_cast<std::int64_t>(own_)};
    comm_->sum(totals);
    const auto [open, news, kept, thrown, all] = totals;
    if (news > 0) hear();
    if (open == 0) return {kept, thrown};
    most_rounds = all + 1;
  }
  throw std::logic_error("rsa: a conflict round decided nothing");
}

// Tell the ranks beyond the border of the darts near it, and those that have later darts of the same particles.
void Conflicts::announce(const Volley& volley) {
  told_.clear();
  std::vector<Rank> near;
  std::vector<Rank> later;
  for (std::size_t k = 0; k < own_; ++k) {
    const Dart& dart = darts_[k];
    border_->ranks(dart.sphere, near);
    for (const Rank rank : near) tell(static_cast<std::int32_t>(k), rank, true);
    if (dart.attempt == volley.last()) continue;
    later.clear();
    for (std::uint32_t attempt = dart.attempt + 1; attempt <= volley.last() && comm_->size() > 1; ++attempt) {
      later.push_back(thrower_->owner(thrower_->dart(dart.particle, dart.sphere.radius, attempt)));
    }
    std::ranges::sort(later);
    later.erase(std::unique(later.begin(), later.end()), later.end());
    for (const Rank rank : later) {
      if (rank != comm_->rank() && !std::ranges::binary_search(near, rank))
        tell(static_cast<std::int32_t>(k), rank, false);
    }
  }
  take_in(announcements_.deliver(*comm_));
  by_particle_.resize(volley.count > 1 ? darts_.size() : 0);
  std::iota(by_particle_.begin(), by_particle_.end(), 0);
  std::ranges::sort(by_particle_, {}, [&](std::int32_t k) {
    const Dart& dart = darts_[static_cast<std::size_t>(k)];
    return std::pair(dart.particle, dart.attempt);
  });
}

void Conflicts::tell(std::int32_t dart, Rank rank, bool near) {
  announcements_.post(rank, {darts_[static_cast<std::size_t>(dart)], near ? 1 : 0});
  told_.push_back({dart, rank});
}

// Foreign darts join the own ones; all are open.
void Conflicts::take_in(std::vector<Announcement> foreign) {
  std::ranges::sort(foreign, {}, [](const Announcement& told) { return turn(told.dart); });
  undecided_.clear();
  near_.clear();
  for (const auto& [dart, near] : foreign) {
    if (near != 0) undecided_.add(dart.sphere, static_cast<std::int32_t>(darts_.size()));
    near_.push_back(near != 0);
    darts_.push_back(dart);
  }
  verdicts_.assign(darts_.size(), Verdict::open);
  open_.resize(own_);
  std::iota(open_.begin(), open_.end(), 0);
}

// All own open darts in order, as far as what is known allows.
void Conflicts::decide(bool first) {
  std::size_t left = 0;
  for (const std::int32_t k : open_) {
    const Dart& dart = darts_[static_cast<std::size_t>(k)];
    const Verdict verdict = ruling(dart);
    if (verdict == Verdict::open) {
      open_[left++] = k;
      if (first) undecided_.add(dart.sphere, k);  // later ones of this rank wait for it in turn
      continue;
    }
    settle(k, verdict);
    if (verdict == Verdict::rejected) continue;
    placed_->add(dart.sphere, 0);
    ++outcome_.kept;
    outcome_.thrown += dart.attempt - first_attempt_ + 1;
  }
  open_.resize(left);
}

// The verdict on an own dart by what is known now. A sphere of this volley that is placed and overlaps it is an earlier
// one: a later one would have waited.
Verdict Conflicts::ruling(const Dart& dart) const {
  if (placed_->overlaps(dart.sphere)) return Verdict::rejected;
  const Verdict verdict = by_particle_.empty() ? Verdict::kept : ruling_of_particle(dart);
  if (verdict != Verdict::kept || undecided_.empty()) return verdict;
  const bool waits = undecided_.any(dart.sphere, [&](std::int32_t other) {
    const auto k = static_cast<std::size_t>(other);
    return verdicts_[k] == Verdict::open && turn(darts_[k]) < turn(dart);
  });
  return waits ? Verdict::open : Verdict::kept;
}

// The same as far as the earlier darts of its particle go.
Verdict Conflicts::ruling_of_particle(const Dart& dart) const {
  Verdict ruling = Verdict::kept;
  for (const std::int32_t other : of_particle(dart.particle)) {
    const auto k = static_cast<std::size_t>(other);
    if (darts_[k].attempt >= dart.attempt) break;
    if (verdicts_[k] == Verdict::kept) return Verdict::rejected;
    if (verdicts_[k] == Verdict::open) ruling = Verdict::open;
  }
  return ruling;
}

std::span<const std::int32_t> Conflicts::of_particle(std::uint64_t particle) const {
  const auto name = [&](std::int32_t k) { return darts_[static_cast<std::size_t>(k)].particle; };
  return {std::ranges::lower_bound(by_particle_, particle, {}, name),
          std::ranges::upper_bound(by_particle_, particle, {}, name)};
}

bool Conflicts::placed_earlier(std::uint64_t particle) const {
  return std::ranges::any_of(of_particle(particle), [&](std::int32_t k) { return kept(static_cast<std::size_t>(k)); });
}

void Conflicts::settle(std::int32_t dart, Verdict verdict) {
  verdicts_[static_cast<std::size_t>(dart)] = verdict;
  const Dart& settled = darts_[static_cast<std::size_t>(dart)];
  for (auto told = std::ranges::lower_bound(told_, dart, {}, &Told::dart); told != told_.end() && told->dart == dart;
       ++told) {
    news_.post(told->rank, {settled.particle, settled.attempt, verdict == Verdict::kept ? 1U : 0U});
  }
}

// What the other ranks decided.
void Conflicts::hear() {
  const auto foreign = std::span(darts_).subspan(own_);
  for (const News& news : news_.deliver(*comm_)) {
    const auto found = std::ranges::lower_bound(foreign, Turn{news.attempt, news.particle}, {}, turn);
    const auto k = static_cast<std::size_t>(found - foreign.begin());
    verdicts_[own_ + k] = news.kept != 0 ? Verdict::kept : Verdict::rejected;
    if (news.kept != 0 && near_[k] != 0) placed_->add(found->sphere, 0);
  }
}

}  // namespace packmpi::rsa
