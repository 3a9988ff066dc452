#include "pack/pack.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <iterator>
#include <string>

#include "disk/files.hpp"
#include "disk/scatter.hpp"
#include "disk/seal.hpp"
#include "pack/pack_file.hpp"
#include "pack/pack_plan.hpp"
#include "pack/samples.hpp"

namespace packmpi::pack {
using namespace disk;
using namespace report;
namespace {

using testing::every_spread;
using testing::Folder;
using testing::Grain;
using testing::Spread;

/// An HDF5 object of the tests, closed at the end.
struct Object {
  hid_t id;
  explicit Object(hid_t opened) : id(opened) {}
  ~Object() {
    if (id >= 0) H5Oclose(id);
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
};

struct File {
  hid_t id;
  explicit File(const std::string& path) : id(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  ~File() { H5Fclose(id); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  [[nodiscard]] bool has(const std::string& path) const { return H5Lexists(id, path.c_str(), H5P_DEFAULT) > 0; }

  /// The raw bytes of a dataset, in its own type.
  [[nodiscard]] std::string bytes(const std::string& path) const {
    const Object set(H5Dopen2(id, path.c_str(), H5P_DEFAULT));
    const hid_t type = H5Dget_type(set.id);
    const hid_t space = H5Dget_space(set.id);
    std::string out(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * H5Tget_size(type), '\0');
    if (!out.empty()) {
      EXPECT_GE(H5Dread(set.id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()), 0) << path;
    }
    H5Sclose(space);
    H5Tclose(type);
    return out;
  }

  [[nodiscard]] std::string attribute(const std::string& object, const char* name) const {
    const hid_t at = H5Aopen_by_name(id, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT);
    if (at < 0) return "(none)";
    const hid_t type = H5Aget_type(at);
    const hid_t space = H5Aget_space(at);
    std::string out(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * H5Tget_size(type), '\0');
    if (H5Tis_variable_str(type) > 0) {
      char* words = nullptr;
      EXPECT_GE(H5Aread(at, type, &words), 0);
      out = words;
      H5free_memory(words);
    } else {
      EXPECT_GE(H5Aread(at, type, out.data()), 0);
    }
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(at);
    return out;
  }

  [[nodiscard]] haddr_t address(const std::string& path) const {
    H5O_info_t info{};
    EXPECT_GE(H5Oget_info_by_name2(id, path.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT), 0) << path;
    return info.addr;
  }
};

template <class T>
std::string raw(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

class Pack : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  Folder folder_{comm_};

  std::string write(const std::string& name, const particles::Layout& layout, const std::vector<Grain>& grains,
                    Spread spread, bool with_contacts) {
    const auto parts = testing::make_parts(comm_, layout, grains, spread);
    write_pack(comm_, folder_.file(name), parts.view(with_contacts), testing::some_record(layout.dimension, 3));
    return folder_.file(name);
  }
};

void expect_grains(const PackRows& pack, const std::vector<Grain>& grains, const particles::Layout& layout) {
  ASSERT_EQ(pack.id.size(), grains.size());
  ASSERT_EQ(pack.spin.size(), layout.rotation ? grains.size() : 0u);
  EXPECT_EQ(pack.dimension, layout.dimension);
  particles::Store one(layout);  // the spin goes through r omega: compare what the store gives
  for (std::size_t k = 0; k < grains.size(); ++k) {
    one.add(static_cast<GlobalId>(k), grains[k].x, grains[k].r, grains[k].v, grains[k].w);
    EXPECT_EQ(pack.id[k], static_cast<GlobalId>(k));
    EXPECT_EQ(pack.position[k], grains[k].x);
    EXPECT_EQ(pack.velocity[k], grains[k].v);
    EXPECT_EQ(pack.radius[k], grains[k].r);
    EXPECT_EQ(pack.layer[k], testing::layer_of(pack.id[k]));
    EXPECT_EQ(pack.contacts[k], testing::contacts_of(pack.id[k]));
    if (layout.rotation) {
      EXPECT_EQ(pack.spin[k], one.spin(static_cast<LocalIndex>(k)));
    }
  }
}

TEST_F(Pack, ParticlesComeBackBitForBitWhereverTheyWere) {
  for (const int dimension : {2, 3}) {
    for (const bool rotation : {true, false}) {
      const auto layout = particles::layout_of(dimension, rotation);
      for (const std::size_t count : {0u, 1u, 5u, 137u}) {  // fewer particles than ranks, too
        const auto grains = testing::some_grains(count, dimension);
        for (const Spread spread : every_spread) {
          const std::string path = write("pack.hdf", layout, grains, spread, false);
          expect_grains(read_pack(path), grains, layout);
          comm_.barrier();
        }
      }
    }
  }
}

TEST_F(Pack, DatasetsDoNotDependOnTheSpread) {
  const auto layout = particles::layout_of(3, true);
  const auto grains = testing::some_grains(101, 3);
  const std::string reference = write("a.hdf", layout, grains, Spread::last, true);
  for (const Spread spread : every_spread) {
    const std::string other = write("b.hdf", layout, grains, spread, true);
    if (comm_.rank() == 0) {
      const File a(reference);
      const File b(other);
      for (const char* path : {"/particles/id",
                               "/particles/position",
                               "/particles/radius",
                               "/particles/velocity",
                               "/particles/spin",
                               "/particles/layer",
                               "/particles/contacts",
                               "/contacts/pair",
                               "/contacts/overlap",
                               "/contacts/normal",
                               "/contacts/force",
                               "/contacts/tangential_displacement",
                               "/contacts/rolling_displacement",
                               "/contacts/twisting_displacement",
                               "/wall_contacts/particle",
                               "/wall_contacts/wall",
                               "/wall_contacts/force",
                               "/wall_contacts/tangential_displacement",
                               "/VTKHDF/Offsets",
                               "/summary/layers/height"}) {
        EXPECT_EQ(a.bytes(path), b.bytes(path)) << path;
      }
    }
    comm_.barrier();
  }
}

TEST_F(Pack, IsTheSameFileInPiecesOfAnySize) {
  const auto layout = particles::layout_of(3, true);
  const auto parts = testing::make_parts(comm_, layout, testing::some_grains(137, 3), Spread::all);
  const report::RunRecord record = testing::some_record(3, 3);
  const auto bytes = [&](std::int64_t piece) {
    write_pack(comm_, folder_.file("pack.hdf"), parts.view(true), record, piece);
    std::ifstream file(folder_.file("pack.hdf"), std::ios::binary);
    std::string all(std::istreambuf_iterator<char>(file), {});
    comm_.barrier();  // nobody writes it anew before all have read it
    return all;
  };
  const std::string whole = bytes(100000);
  for (const std::int64_t piece : {1, 7, 50}) EXPECT_TRUE(bytes(piece) == whole) << piece;  // up to sixteen pieces
}

TEST_F(Pack, ContactsAreSortedByPair) {
  const std::size_t count = 101;
  const auto grains = testing::some_grains(count, 3);
  const std::string path = write("pack.hdf", particles::layout_of(3, true), grains, Spread::some, true);
  if (comm_.rank() != 0) return;
  std::string pair, overlap, force, normal, slip, roll, twist, walls, of, wall_overlap;
  for (GlobalId id = 0; id < static_cast<GlobalId>(count); ++id) {
    auto rows = testing::contact_rows(id, count);
    std::reverse(rows.begin(), rows.end());  // by the second
    for (const ContactRow& row : rows) {
      pair += raw(row.first) + raw(row.second);
      overlap += raw(row.overlap);
      force += raw(row.force);
      normal += raw(row.normal);
      slip += raw(row.springs.tangential);
      roll += raw(row.springs.rolling);
      twist += raw(row.springs.twisting);
    }
    auto at_walls = testing::wall_rows(id);
    std::reverse(at_walls.begin(), at_walls.end());
    for (const ContactRow& row : at_walls) {
      of += raw(row.first);
      walls += raw(static_cast<std::int32_t>(-1 - row.second));
      wall_overlap += raw(row.overlap);
    }
  }
  const File file(path);
  EXPECT_EQ(file.bytes("/contacts/pair"), pair);
  EXPECT_EQ(file.bytes("/contacts/overlap"), overlap);
  EXPECT_EQ(file.bytes("/contacts/force"), force);
  EXPECT_EQ(file.bytes("/contacts/normal"), normal);
  EXPECT_EQ(file.bytes("/contacts/tangential_displacement"), slip);
  EXPECT_EQ(file.bytes("/contacts/rolling_displacement"), roll);
  EXPECT_EQ(file.bytes("/contacts/twisting_displacement"), twist);
  EXPECT_EQ(file.bytes("/wall_contacts/particle"), of);
  EXPECT_EQ(file.bytes("/wall_contacts/wall"), walls);
  EXPECT_EQ(file.bytes("/wall_contacts/overlap"), wall_overlap);
}

TEST_F(Pack, WithoutRotationOrContactsTheirDatasetsAreAbsent) {
  const std::string path =
      write("pack.hdf", particles::layout_of(3, false), testing::some_grains(9, 3), Spread::all, false);
  if (comm_.rank() != 0) return;
  const File file(path);
  EXPECT_FALSE(file.has("/particles/spin"));
  EXPECT_FALSE(file.has("/VTKHDF/PointData/spin"));
  EXPECT_FALSE(file.has("/contacts"));
  EXPECT_FALSE(file.has("/wall_contacts"));
}

TEST_F(Pack, NoContactsAtAllIsAnEmptyTable) {
  auto parts = testing::make_parts(comm_, particles::layout_of(3, true), testing::some_grains(9, 3), Spread::all);
  parts.rows.clear();
  write_pack(comm_, folder_.file("pack.hdf"), parts.view(true), testing::some_record(3, 0));
  if (comm_.rank() != 0) return;
  const File file(folder_.file("pack.hdf"));
  EXPECT_TRUE(file.has("/contacts/pair"));
  EXPECT_EQ(file.bytes("/contacts/pair"), "");
  EXPECT_EQ(file.bytes("/summary/layers/height"), "");
}

TEST_F(Pack, SaysWhatItIs) {
  const auto record = testing::some_record(3, 3);
  const std::string path =
      write("pack.hdf", particles::layout_of(3, true), testing::some_grains(20, 3), Spread::all, true);
  if (comm_.rank() != 0) return;
  const File file(path);
  EXPECT_EQ(file.attribute("/", "format"), "packmpi-pack");
  EXPECT_EQ(file.attribute("/", "format_version"), raw(std::int64_t{2}));
  EXPECT_EQ(file.attribute("/particles/position", "unit"), "m");
  EXPECT_EQ(file.attribute("/particles/spin", "unit"), "rad/s");
  EXPECT_EQ(file.attribute("/contacts/force", "unit"), "N");
  EXPECT_EQ(file.attribute("/summary", "phi"), raw(record.phi));
  EXPECT_EQ(file.attribute("/summary", "size"), raw(record.size));
  EXPECT_EQ(file.attribute("/summary/audit", "found"), raw(record.audit.found));
  EXPECT_EQ(file.attribute("/provenance", "effective_input"), record.effective_input);
  EXPECT_EQ(file.attribute("/provenance", "seed"), raw(record.seed));
  EXPECT_EQ(file.bytes("/summary/layers/stop_reason"), std::string("durationsettled\0duration", 24));
}

TEST_F(Pack, ViewIsMadeOfHardLinks) {
  const std::string path =
      write("pack.hdf", particles::layout_of(3, true), testing::some_grains(20, 3), Spread::runs, false);
  if (comm_.rank() != 0) return;
  const File file(path);
  EXPECT_EQ(file.attribute("/VTKHDF", "Type"), "UnstructuredGrid");
  EXPECT_EQ(file.address("/VTKHDF/Points"), file.address("/particles/position"));
  EXPECT_EQ(file.address("/VTKHDF/Connectivity"), file.address("/particles/id"));
  EXPECT_EQ(file.address("/VTKHDF/PointData/radius"), file.address("/particles/radius"));
  EXPECT_EQ(file.bytes("/VTKHDF/NumberOfPoints"), raw(std::int64_t{20}));
  EXPECT_EQ(file.bytes("/VTKHDF/Offsets"), raw(std::int64_t{0}) + raw(std::int64_t{20}));
  EXPECT_EQ(file.bytes("/VTKHDF/Types"), "\2");
}

TEST_F(Pack, ReaderRefusesWhatIsNoPack) {
  const std::string path = folder_.file("not" + std::to_string(comm_.rank()) + ".hdf");
  std::ofstream(path) << "not a pack";
  for (const std::string& bad : {path, folder_.file("absent.hdf")}) {
    try {
      (void)read_pack(bad);
      FAIL() << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::io_failure);
      EXPECT_NE(std::string(error.what()).find(bad), std::string::npos) << error.what();
    }
  }
}

// By the reader of the whole, and by all ranks together. The last byte stands for every way to cut the seal off.
TEST_F(Pack, AFlippedBitAnywhereIsRefused) {
  const auto layout = particles::layout_of(3, true);
  const std::string path = write("valid.hdf", layout, testing::some_grains(137, 3), Spread::all, true);
  const std::string damaged_path = folder_.file("damaged.hdf");
  std::ifstream file(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NO_THROW(check_pack(comm_, path));
  for (std::size_t at = 0; at < whole.size();
       at += whole.size() - at == 1 ? 1 : std::min<std::size_t>(1009, whole.size() - at - 1)) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
    comm_.barrier();
    if (comm_.rank() == 0) std::ofstream(damaged_path, std::ios::binary) << damaged;
    comm_.barrier();
    EXPECT_THROW(check_pack(comm_, damaged_path), Error) << "byte " << at << " of " << whole.size();
    EXPECT_THROW((void)read_pack(damaged_path), Error) << "byte " << at << " of " << whole.size();
    EXPECT_TRUE(is_pack(damaged_path) || at < 65536) << "byte " << at;
  }
}

TEST(Seal, KnowsEveryRowAndWhereItIs) {
  const std::vector<std::uint64_t> rows{3, 5, 3, 9}, swapped{5, 3, 3, 9}, other{3, 5, 3, 8};
  const auto digest = [](const std::vector<std::uint64_t>& numbers, std::int64_t first) {
    return rows_digest(std::as_bytes(std::span(numbers)), sizeof(std::uint64_t), first);
  };
  EXPECT_NE(digest(rows, 0), digest(swapped, 0));
  EXPECT_NE(digest(rows, 0), digest(other, 0));
  EXPECT_NE(digest(rows, 0), digest(rows, 1));
  const std::vector<std::uint64_t> first{3, 5}, second{3, 9};
  EXPECT_EQ(digest(rows, 0), digest(first, 0) + digest(second, 2)) << "shares of ranks add up";
}

TEST_F(Pack, IdsAreSharedOutHoweverManyThereAre) {
  for (const std::int64_t total : {std::int64_t{1}, (std::int64_t{1} << 31) + 1, (std::int64_t{3} << 31) + 7,
                                   std::int64_t{1} << 33, (std::int64_t{1} << 40) - 1}) {
    for (const std::int64_t ranks : {1, 3, 1000, 65537, 1 << 20}) {
      const IdBlocks blocks{total, ranks};
      EXPECT_EQ(blocks.begin(0), 0);
      EXPECT_EQ(blocks.begin(static_cast<Rank>(ranks)), total);
      for (const std::int64_t r : {std::int64_t{0}, ranks / 3, ranks / 2, ranks - 1}) {
        const auto rank = static_cast<Rank>(r);
        const GlobalId begin = blocks.begin(rank), end = blocks.begin(rank + 1);
        ASSERT_LE(begin, end);
        ASSERT_LE(end - begin, total / ranks + 1);
        if (begin == end) continue;
        ASSERT_EQ(blocks.owner(begin), rank);
        ASSERT_EQ(blocks.owner(end - 1), rank);
      }
    }
  }
}

TEST_F(Pack, RowsBeyondTwoToTheThirtyThirdGoToTheirWriters) {
  struct Row {
    GlobalId id;
    std::int64_t from;
  };
  const std::int64_t total = (std::int64_t{1} << 33) + 11;
  const IdBlocks blocks{total, comm_.size()};
  std::vector<Row> rows;
  for (int k = 0; k < 100; ++k)
    rows.push_back({total - 1 - (k * comm_.size() + comm_.rank()) * (std::int64_t{80000000} / comm_.size()), k});
  rows = scatter(comm_, blocks, std::move(rows), &Row::id);
  EXPECT_EQ(comm_.sum(std::ssize(rows)), 100 * comm_.size());
  for (const Row& row : rows) EXPECT_EQ(blocks.owner(row.id), comm_.rank());
}

// The last rows of a pack of more than 2^31 particles and 3 x 2^31 contacts: a file with a hole in the place of the
// others. HDF5 finds them where they were put.
TEST_F(Pack, RowsBeyondTwoToTheThirtyFirstLieWhereTheyShould) {
  if (comm_.rank() != 0) return;
  const std::int64_t total = (std::int64_t{1} << 31) + 12345;
  PackBlock block;
  block.particles = {static_cast<hsize_t>(total), static_cast<hsize_t>(total - 3), 3};
  for (GlobalId id = total - 3; id < total; ++id) {
    const auto x = static_cast<double>(id);
    block.rows.push_back(
        {id, {x, -x, 0.5}, {1.0, x, 2.0}, {3.0, 4.0, x}, 0.25 * x, 7, static_cast<int>(total - id), 0});
  }
  block.has_contacts = true;
  block.contacts = {static_cast<hsize_t>(3 * total), static_cast<hsize_t>(3 * total - 1), 1};
  block.contact_rows.push_back({.first = total - 2, .second = total - 1, .overlap = 1e-3, .force = {1.0, 2.0, 3.0}});
  const std::vector<h5::Column> plan = plan_columns(block);

  const std::string path = folder_.file("large.hdf");
  std::vector<std::int64_t> places;
  {
    const h5::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, "create");
    write_frame(file.get(), block, plan, testing::some_record(3, 1));
    for (const h5::Column& column : plan) places.push_back(h5::place_of(file.get(), column));
  }
  {
    Descriptor disk(path, O_WRONLY);
    for (std::size_t k = 0; k < plan.size(); ++k)
      disk.write_at(plan[k].bytes(0, plan[k].slab.count), h5::place_of_rows(plan[k], places[k]));
    Seal seal;  // the rows' own digests are of no interest here: 300 GB of them are a hole
    for (std::size_t k = 0; k < plan.size(); ++k) {
      seal.columns.push_back({.place = places[k],
                              .rows = static_cast<std::int64_t>(plan[k].slab.total),
                              .row_bytes = static_cast<std::int64_t>(h5::row_bytes(plan[k]))});
    }
    seal.end = static_cast<std::int64_t>(std::filesystem::file_size(path));
    std::ifstream read(path, std::ios::binary);
    seal.frame = frame_digest(seal, [&](std::int64_t begin, std::int64_t size) {
      std::string bytes(static_cast<std::size_t>(size), '\0');
      read.seekg(begin).read(bytes.data(), size);
      return bytes;
    });
    const std::string sealed = to_bytes(seal);
    disk.write_at(std::as_bytes(std::span(sealed)), seal.end);
    disk.close();
  }
  const PackFile pack(path);
  ASSERT_EQ(pack.count(), total);
  const PackRows got = pack.rows(total - 3, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const ParticleRow& row = block.rows[k];
    EXPECT_EQ(got.id[k], row.id);
    EXPECT_EQ(got.position[k], row.position);
    EXPECT_EQ(got.velocity[k], row.velocity);
    EXPECT_EQ(got.spin[k], row.spin);
    EXPECT_EQ(got.radius[k], row.radius);
    EXPECT_EQ(got.layer[k], row.layer);
    EXPECT_EQ(got.contacts[k], row.contacts);
  }
  const File file(path);
  const Object pairs(H5Dopen2(file.id, "/contacts/pair", H5P_DEFAULT));
  const hid_t there = H5Dget_space(pairs.id);
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(3 * total - 1), 0}, count{1, 2};
  H5Sselect_hyperslab(there, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  const hid_t here = H5Screate_simple(2, count.data(), nullptr);
  std::array<std::int64_t, 2> pair{};
  EXPECT_GE(H5Dread(pairs.id, H5T_NATIVE_INT64, here, there, H5P_DEFAULT, pair.data()), 0);
  EXPECT_EQ(pair, (std::array<std::int64_t, 2>{total - 2, total - 1}));
  H5Sclose(here);
  H5Sclose(there);
}

}  // namespace
}  // namespace packmpi::pack
