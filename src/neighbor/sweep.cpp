#include "neighbor/sweep.hpp"

#include <algorithm>

namespace packmpi::neighbor {
namespace {

// By half, the first owned slot with a ghost of it as partner; `owned` if there is none.
std::array<LocalIndex, 2> first_needs(LocalIndex owned, const PairList& pairs, const Halo& halo) {
  const auto ghosts = static_cast<std::size_t>(halo.ghosts());
  std::vector<unsigned char> of_second(ghosts, 0);
  for (const LocalIndex slot : halo.ghosts(Half::second)) of_second[static_cast<std::size_t>(slot - owned)] = 1;
  std::array<LocalIndex, 2> first{owned, owned};
  for (std::size_t p = 0; p < pairs.first.size() && (first[0] == owned || first[1] == owned); ++p) {
    if (pairs.second[p] < owned) continue;
    const auto ghost = static_cast<std::size_t>(pairs.second[p] - owned);
    if (ghost >= ghosts) continue;  // it stands still
    LocalIndex& mine = first[static_cast<std::size_t>(of_second[ghost])];
    mine = std::min(mine, pairs.first[p]);
  }
  return first;
}

}  // namespace

std::vector<Leg> make_sweep(LocalIndex owned, const PairList& pairs, const WallList& walls, const Halo& halo) {
  std::array<LocalIndex, 2> send{halo.ready(Half::first), halo.ready(Half::second)};
  const bool alone = halo.ghosts() == 0 && send[0] == 0 && send[1] == 0;
  if (owned == 0 || alone)
    return {{owned, std::ssize(pairs.first), std::ssize(walls.particle), {true, true}, {true, true}}};
  std::array<LocalIndex, 2> need = first_needs(owned, pairs, halo);
  std::vector<LocalIndex> ends{owned};
  for (std::size_t half = 0; half < 2; ++half) {
    need[half] = std::min(need[half], (send[half] > 0 ? send[half] : owned) - 1);
    send[half] = std::max({send[half], need[half] + 1, half > 0 ? send[0] : 0});
    ends.push_back(need[half]);
    ends.push_back(send[half]);
  }
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());

  std::vector<Leg> legs;
  LocalIndex begin = 0;
  for (const LocalIndex end : ends) {
    if (end == 0) continue;
    Leg leg{end,
            std::ranges::lower_bound(pairs.first, end) - pairs.first.begin(),
            std::ranges::lower_bound(walls.particle, end) - walls.particle.begin(),
            {},
            {}};
    for (std::size_t half = 0; half < 2; ++half) {
      leg.needs[half] = begin <= need[half] && need[half] < end;
      leg.sends[half] = begin < send[half] && send[half] <= end;
    }
    legs.push_back(leg);
    begin = end;
  }
  return legs;
}

}  // namespace packmpi::neighbor
