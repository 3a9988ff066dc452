#include "rsa/conflicts.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

namespace packmpi::rsa {
namespace {

constexpr std::size_t ahead = 8;  // trials: what they will ask for is fetched, as they come in no order of place

}  // namespace

Conflicts::Outcome Conflicts::resolve(std::span<const Trial> trials, const Volley& volley) {
  own_ = trials.size();
  outcome_ = {};
  first_attempt_ = volley.first;
  trials_.assign(trials.begin(), trials.end());
  announce(volley);
  std::int64_t most_rounds = 1;  // known after the first sum: a round decides one trial at least
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

// Tell the ranks beyond the border of the trials near it, and those that have later trials of the same particles.
void Conflicts::announce(const Volley& volley) {
  told_.clear();
  std::vector<Rank> near;
  std::vector<Rank> later;
  for (std::size_t k = 0; k < own_; ++k) {
    const Trial& trial = trials_[k];
    border_->ranks(trial.sphere, near);
    for (const Rank rank : near) tell(static_cast<std::int32_t>(k), rank, true);
    if (trial.attempt == volley.last()) continue;
    later.clear();
    for (std::uint32_t attempt = trial.attempt + 1; attempt <= volley.last() && comm_->size() > 1; ++attempt) {
      later.push_back(sampler_->owner(sampler_->trial(trial.particle, trial.sphere.radius, attempt)));
    }
    std::ranges::sort(later);
    later.erase(std::unique(later.begin(), later.end()), later.end());
    for (const Rank rank : later) {
      if (rank != comm_->rank() && !std::ranges::binary_search(near, rank))
        tell(static_cast<std::int32_t>(k), rank, false);
    }
  }
  take_in(announcements_.deliver(*comm_));
  by_particle_.resize(volley.count > 1 ? trials_.size() : 0);
  std::iota(by_particle_.begin(), by_particle_.end(), 0);
  std::ranges::sort(by_particle_, {}, [&](std::int32_t k) {
    const Trial& trial = trials_[static_cast<std::size_t>(k)];
    return std::pair(trial.particle, trial.attempt);
  });
}

void Conflicts::tell(std::int32_t trial, Rank rank, bool near) {
  announcements_.post(rank, {trials_[static_cast<std::size_t>(trial)], near ? 1 : 0});
  told_.push_back({trial, rank});
}

// Foreign trials join the own ones; all are open.
void Conflicts::take_in(std::vector<Announcement> foreign) {
  std::ranges::sort(foreign, {}, [](const Announcement& told) { return turn(told.trial); });
  undecided_.clear();
  near_.clear();
  for (const auto& [trial, near] : foreign) {
    if (near != 0) undecided_.add(trial.sphere, static_cast<std::int32_t>(trials_.size()));
    near_.push_back(near != 0);
    trials_.push_back(trial);
  }
  verdicts_.assign(trials_.size(), Verdict::open);
  open_.resize(own_);
  std::iota(open_.begin(), open_.end(), 0);
}

// All own open trials in order, as far as what is known allows.
void Conflicts::decide(bool first) {
  std::size_t left = 0;
  const auto sphere = [&](std::size_t at) -> const Sphere& {
    return trials_[static_cast<std::size_t>(open_[at])].sphere;
  };
  for (std::size_t at = 0; at < open_.size(); ++at) {
    if (at + 2 * ahead < open_.size()) placed_->fetch_cells(sphere(at + 2 * ahead));
    if (at + ahead < open_.size()) placed_->fetch_spheres(sphere(at + ahead));
    const std::int32_t k = open_[at];
    const Trial& trial = trials_[static_cast<std::size_t>(k)];
    const Verdict verdict = ruling(trial);
    if (verdict == Verdict::open) {
      open_[left++] = k;
      if (first) undecided_.add(trial.sphere, k);  // later ones of this rank wait for it in turn
      continue;
    }
    settle(k, verdict);
    if (verdict == Verdict::rejected) continue;
    placed_->add(trial.sphere);
    ++outcome_.kept;
    outcome_.thrown += trial.attempt - first_attempt_ + 1;
  }
  open_.resize(left);
}

// The verdict on an own trial by what is known now. A sphere of this volley that is placed and overlaps it is an
// earlier one: a later one would have waited.
Verdict Conflicts::ruling(const Trial& trial) const {
  if (placed_->overlaps(trial.sphere)) return Verdict::rejected;
  const Verdict verdict = by_particle_.empty() ? Verdict::kept : ruling_of_particle(trial);
  if (verdict != Verdict::kept || undecided_.empty()) return verdict;
  const bool waits = undecided_.any(trial.sphere, [&](std::int32_t other) {
    const auto k = static_cast<std::size_t>(other);
    return verdicts_[k] == Verdict::open && turn(trials_[k]) < turn(trial);
  });
  return waits ? Verdict::open : Verdict::kept;
}

// The same as far as the earlier trials of its particle go.
Verdict Conflicts::ruling_of_particle(const Trial& trial) const {
  Verdict ruling = Verdict::kept;
  for (const std::int32_t other : of_particle(trial.particle)) {
    const auto k = static_cast<std::size_t>(other);
    if (trials_[k].attempt >= trial.attempt) break;
    if (verdicts_[k] == Verdict::kept) return Verdict::rejected;
    if (verdicts_[k] == Verdict::open) ruling = Verdict::open;
  }
  return ruling;
}

std::span<const std::int32_t> Conflicts::of_particle(std::uint64_t particle) const {
  const auto name = [&](std::int32_t k) { return trials_[static_cast<std::size_t>(k)].particle; };
  return {std::ranges::lower_bound(by_particle_, particle, {}, name),
          std::ranges::upper_bound(by_particle_, particle, {}, name)};
}

bool Conflicts::placed_earlier(std::uint64_t particle) const {
  return std::ranges::any_of(of_particle(particle), [&](std::int32_t k) { return kept(static_cast<std::size_t>(k)); });
}

void Conflicts::settle(std::int32_t trial, Verdict verdict) {
  verdicts_[static_cast<std::size_t>(trial)] = verdict;
  const Trial& settled = trials_[static_cast<std::size_t>(trial)];
  for (auto told = std::ranges::lower_bound(told_, trial, {}, &Told::trial);
       told != told_.end() && told->trial == trial; ++told) {
    news_.post(told->rank, {settled.particle, settled.attempt, verdict == Verdict::kept ? 1U : 0U});
  }
}

// What the other ranks decided.
void Conflicts::hear() {
  const auto foreign = std::span(trials_).subspan(own_);
  for (const News& news : news_.deliver(*comm_)) {
    const auto found = std::ranges::lower_bound(foreign, Turn{news.attempt, news.particle}, {}, turn);
    const auto k = static_cast<std::size_t>(found - foreign.begin());
    verdicts_[own_ + k] = news.kept != 0 ? Verdict::kept : Verdict::rejected;
    if (news.kept != 0 && near_[k] != 0) placed_->add(found->sphere);
  }
}

}  // namespace packmpi::rsa
