#include "handover/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace packmpi::handover {
namespace {

constexpr std::int64_t batch_rows = 1 << 14;

pack::ParticleRow row_of(const pack::PackRows& rows, std::size_t k) {
  return {rows.id[k],     rows.position[k], rows.velocity[k], rows.spin.empty() ? Vec3{} : rows.spin[k],
          rows.radius[k], rows.layer[k],    rows.contacts[k], rows.component.empty() ? 0 : rows.component[k]};
}

}  // namespace

bool Selection::kept(const pack::ParticleRow& row) const {
  if (cut_.on()) return cut_.keeps(row.position, row.radius);
  const double centre = row.position[static_cast<std::size_t>(scene_->container.vertical())];
  switch (choice_.trim) {
    case Trim::drop:
      return centre + row.radius <= scene_->container.height();
    case Trim::cut:
      return centre <= scene_->container.height();
    case Trim::none:
      break;
  }
  return true;
}

pack::PackRows Selection::read(std::int64_t first, std::int64_t count) const {
  try {
    pack::PackRows rows = file_->rows(first, count);
    pack::check_in_scene(rows, *scene_);
    return rows;
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("cannot read {}: {}", choice_.pack, error.what()));
  }
}

void Selection::visit_batch(std::int64_t copy, const pack::PackRows& rows,
                            const std::function<void(const pack::ParticleRow&)>& take) const {
  const std::array<std::int64_t, 2> at{copy % choice_.copies[0], copy / choice_.copies[0]};
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    pack::ParticleRow row = row_of(rows, k);
    if (!kept(row)) continue;
    row.id += copy * file_->count() + 1;
    if (cut_.on()) row.position = cut_.place(row.position);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (at[axis] == 0) continue;
      const double end = scene_->container.size[axis] * choice_.copies[axis];  // rounding must not reach it
      row.position[axis] = std::min(row.position[axis] + static_cast<double>(at[axis]) * scene_->container.size[axis],
                                    std::nextafter(end, 0.0));
    }
    take(row);
  }
}

void Selection::visit(std::int64_t begin, std::int64_t end,
                      const std::function<void(const pack::ParticleRow&)>& take) const {
  const std::int64_t n = file_->count();
  while (begin < end) {
    const std::int64_t first = begin % n;
    const std::int64_t count = std::min({batch_rows, end - begin, n - first});
    visit_batch(begin / n, read(first, count), take);
    begin += count;
  }
}

std::int64_t Selection::solid_quanta(std::int64_t begin, std::int64_t end, double quanta_a_volume) const {
  std::int64_t quanta = 0;
  while (begin < end) {
    const std::int64_t count = std::min(batch_rows, end - begin);
    const pack::PackRows rows = read(begin, count);
    for (std::size_t k = 0; k < rows.id.size(); ++k) {
      quanta += std::llround(cut_.solid(rows.position[k], rows.radius[k]) * quanta_a_volume);
    }
    begin += count;
  }
  return quanta;
}

}  // namespace packmpi::handover
