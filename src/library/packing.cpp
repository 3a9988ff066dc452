// Packs in memory: include/packmpi/packing.hpp.
#include "packmpi/packing.hpp"

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "disk/scatter.hpp"
#include "library/failure.hpp"
#include "library/rows.hpp"
#include "pack/pack.hpp"
#include "report/report.hpp"
#include "scene/mixture.hpp"

namespace packmpi {
namespace {

constexpr std::size_t longest_record = 16;  // doubles (particles/layout.hpp)

/// A particle on its way.
struct ParticleRow {
  GlobalId id = 0;
  std::array<double, longest_record> record{};
  std::int32_t layer = 0, contacts = 0;
};

void append(std::vector<double>& all, const Vec3& v) { all.insert(all.end(), v.begin(), v.end()); }

/// Fills in a share from particles sorted by id.
void take(const std::vector<ParticleRow>& particles, Packing::Rows& rows) {
  const bool rotation = rows.store.layout().rotation, mixture = rows.store.layout().component >= 0;
  for (const ParticleRow& particle : particles) {
    rows.store.add_record(particle.id, particle.record.data());
    const LocalIndex i = rows.store.owned() - 1;
    rows.id.push_back(particle.id);
    append(rows.position, rows.store.position(i));
    append(rows.velocity, rows.store.velocity(i));
    if (rotation) append(rows.spin, rows.store.spin(i));
    rows.radius.push_back(rows.store.radius(i));
    if (mixture) rows.component.push_back(scene::component_of(rows.store.substance(i).code));
    rows.layer.push_back(particle.layer);
    rows.contacts.push_back(particle.contacts);
  }
}

ContactArrays arrays_of(const std::vector<observe::ContactForce>& contacts, bool of_walls, bool memory) {
  ContactArrays arrays;
  for (const observe::ContactForce& contact : contacts) {
    arrays.pair.push_back(contact.first);
    if (of_walls) {
      arrays.wall.push_back(static_cast<std::int32_t>(neighbor::wall_partner(neighbor::Wall{}) - contact.second));
    } else {
      arrays.pair.push_back(contact.second);
    }
    arrays.overlap.push_back(contact.overlap);
    append(arrays.normal, contact.normal);
    append(arrays.force, contact.force);
    if (memory) append(arrays.displacement, contact.springs.tangential);
  }
  return arrays;
}

ContactSpans spans_of(const ContactArrays& arrays) {
  return {arrays.pair, arrays.wall, arrays.overlap, arrays.normal, arrays.force, arrays.displacement};
}

/// What is to be shown of contacts, once their rows are there.
void show_contacts(Packing::Rows& rows) {
  rows.pair_arrays = arrays_of(rows.pair_rows, false, rows.features.memory);
  rows.wall_arrays = arrays_of(rows.wall_rows, true, rows.features.memory);
  rows.pairs = spans_of(rows.pair_arrays);
  rows.walls = spans_of(rows.wall_arrays);
}

std::vector<ParticleRow> particles_of(const particles::Store& store, const std::vector<std::int32_t>& layers,
                                      const std::vector<std::int32_t>& contacts) {
  const particles::Layout& layout = store.layout();
  std::vector<ParticleRow> particles(static_cast<std::size_t>(store.owned()));
  for (std::size_t k = 0; k < particles.size(); ++k) {
    particles[k] = {.id = store.ids()[k], .record = {}, .layer = layers[k], .contacts = contacts[k]};
    const double* record = store.record(static_cast<LocalIndex>(k));
    double* to = particles[k].record.data();
    std::copy_n(record, layout.used_doubles(), to);
    if (layout.component >= 0) std::copy_n(record + layout.component, 2, to + layout.component);
  }
  std::ranges::sort(particles, {}, &ParticleRow::id);
  return particles;
}

}  // namespace

std::shared_ptr<const Packing::Rows> library::rows_of(const run::Bed& bed, const report::RunRecord& record) {
  const neighbor::Neighborhood& near = bed.neighborhood;
  auto rows = std::make_shared<Packing::Rows>(bed.store.layout());
  rows->features = bed.scene.features;
  rows->writes_contacts = bed.scene.in.output.contacts;
  rows->record = record;
  rows->summary = report::to_json(record);
  const observe::Contacts touching = observe::contacts(bed.comm, bed.store, bed.scene, near.pairs(), near.walls());
  take(particles_of(bed.store, bed.layers(), touching.of_particle), *rows);
  rows->pair_rows = observe::contact_forces(bed.store, bed.scene, near.pairs(), dynamics::stored_pairs(near));
  rows->wall_rows = observe::wall_forces(bed.store, bed.scene, near.walls(), dynamics::stored_walls(near));
  rows->maps = observe::column_maps(bed.comm, bed.store, bed.scene, near.pairs(), dynamics::stored_pairs(near));
  show_contacts(*rows);
  return rows;
}

std::int64_t Packing::count() const noexcept { return std::ssize(rows_->id); }
std::span<const std::int64_t> Packing::id() const noexcept { return rows_->id; }
std::span<const double> Packing::position() const noexcept { return rows_->position; }
std::span<const double> Packing::radius() const noexcept { return rows_->radius; }
std::span<const double> Packing::velocity() const noexcept { return rows_->velocity; }
std::span<const double> Packing::spin() const noexcept { return rows_->spin; }
std::span<const std::int32_t> Packing::layer() const noexcept { return rows_->layer; }
std::span<const std::int32_t> Packing::component() const noexcept { return rows_->component; }
std::span<const std::int32_t> Packing::contacts() const noexcept { return rows_->contacts; }
const ContactSpans& Packing::pair_contacts() const noexcept { return rows_->pairs; }
const ContactSpans& Packing::wall_contacts() const noexcept { return rows_->walls; }
const std::string& Packing::summary() const noexcept { return rows_->summary; }
const std::vector<std::string>& Packing::missed() const noexcept { return rows_->record.missed; }
double Packing::phi_bulk() const noexcept { return rows_->record.phi_bulk; }
double Packing::height() const noexcept { return rows_->record.height; }

Packing Packing::gathered(MPI_Comm world) const {
  const comm::Comm comm(world);
  auto all = std::make_shared<Rows>(rows_->store.layout());
  library::together(comm, "", [&] {
    const disk::IdBlocks to_first{.total = std::max<std::int64_t>(1, rows_->record.particles), .ranks = 1};
    take(disk::scatter(comm, to_first, particles_of(rows_->store, rows_->layer, rows_->contacts), &ParticleRow::id),
         *all);
    const auto by_ends = [](const observe::ContactForce& a, const observe::ContactForce& b) {
      return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    };
    all->pair_rows = disk::scatter(comm, to_first, rows_->pair_rows, &observe::ContactForce::first);
    all->wall_rows = disk::scatter(comm, to_first, rows_->wall_rows, &observe::ContactForce::first);
    std::ranges::sort(all->pair_rows, by_ends);
    std::ranges::sort(all->wall_rows, by_ends);
  });
  all->maps = rows_->maps;
  all->features = rows_->features;
  all->writes_contacts = rows_->writes_contacts;
  all->record = rows_->record;
  all->summary = rows_->summary;
  show_contacts(*all);
  return Packing(all);
}

void Packing::write(MPI_Comm world, const std::string& path, bool force) const {
  const comm::Comm comm(world);
  library::together(comm, "", [&] {
    comm::agree_on(comm, [&] {
      if (comm.rank() == 0 && !force && std::filesystem::exists(path)) {
        throw Error(ExitCode::bad_input, path + " exists; say that it may be replaced (force), or take another name");
      }
    });
    const pack::PackParts parts{.store = &rows_->store,
                                .layer = rows_->layer,
                                .contacts = rows_->contacts,
                                .contact_rows = rows_->writes_contacts ? &rows_->pair_rows : nullptr,
                                .maps = &rows_->maps,
                                .wall_rows = &rows_->wall_rows,
                                .features = rows_->features};
    pack::write_pack(comm, path, parts, rows_->record);
  });
}

}  // namespace packmpi
