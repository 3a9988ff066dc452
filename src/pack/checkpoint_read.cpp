#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "disk/hdf5.hpp"
#include "disk/scatter.hpp"
#include "disk/seal.hpp"
#include "pack/checkpoint.hpp"
#include "pack/former_names.hpp"
#include "pack/run_state.hpp"

namespace packmpi::pack {
namespace {

[[noreturn]] void refuse_checkpoint(const std::string& words) { throw Error(ExitCode::bad_checkpoint, words); }

template <class T>
T read_attribute(hid_t file, const char* name) {
  const disk::h5::Handle attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose,
                                   fmt::format("open the attribute {}", name));
  const disk::h5::Handle space(H5Aget_space(attribute.get()), H5Sclose, "ask for a data space");
  if (H5Sget_simple_extent_npoints(space.get()) != 1)
    refuse_checkpoint(fmt::format("the attribute {} is no single number", name));
  T value{};
  disk::h5::check(H5Aread(attribute.get(), disk::h5::type_of<T>(), &value), fmt::format("read the attribute {}", name));
  return value;
}

void expect_shape(const disk::h5::Handle& dataset, const std::string& path, const std::vector<hsize_t>& expected) {
  const disk::h5::Handle space(H5Dget_space(dataset.get()), H5Sclose, "ask for a data space");
  const int axes = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> sizes(expected.size());
  if (axes == static_cast<int>(expected.size())) {
    disk::h5::check(H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr), "ask for an extent");
    if (sizes == expected) return;
  }
  refuse_checkpoint(fmt::format("{} has another shape than it should", path));
}

std::string read_bytes(hid_t file, const std::string& path) {
  constexpr hssize_t longest = hssize_t{1} << 30;
  const disk::h5::Handle dataset = disk::h5::open_dataset(file, path);
  const disk::h5::Handle space(H5Dget_space(dataset.get()), H5Sclose, "ask for a data space");
  const hssize_t size = H5Sget_simple_extent_npoints(space.get());
  if (size < 0 || size > longest) refuse_checkpoint(fmt::format("{} is too long", path));
  std::string text(static_cast<std::size_t>(size), '\0');
  if (size > 0) {
    disk::h5::check(H5Dread(dataset.get(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()),
                    "read " + path);
  }
  return text;
}

disk::h5::Handle open_file(const std::string& path) {
  if (!std::filesystem::exists(path)) refuse_checkpoint("there is no such file");
  (void)disk::check_frame(path);  // the particles are held to their own digest
  disk::h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open it");
  if (H5Aexists(file.get(), "format_version") <= 0 || H5Aexists(file.get(), "text_digest") <= 0) {
    refuse_checkpoint("it is not a checkpoint of packmpi");
  }
  const auto version = read_attribute<std::int64_t>(file.get(), "format_version");
  if (version < oldest_checkpoint_version || version > checkpoint_version) {
    refuse_checkpoint(
        fmt::format("it has format version {}, and this packmpi reads {} to {}: go on with the packmpi "
                    "that wrote it, or begin anew",
                    version, oldest_checkpoint_version, checkpoint_version));
  }
  return file;
}

RunState state_in(hid_t file) {
  const std::string text = read_bytes(file, "/state");
  const std::string scene = read_bytes(file, "/effective_input");
  if (hash_of(text + scene) != read_attribute<std::uint64_t>(file, "text_digest")) {
    refuse_checkpoint("the digest of its state and scene is wrong: the file is damaged");
  }
  const bool former = read_attribute<std::int64_t>(file, "format_version") < checkpoint_version;
  RunState state = state_of(former ? state_in_present_names(text) : text);
  state.effective_input = former ? scene_in_present_names(scene) : scene;
  const bool valid = state.count >= 0 && state.steps >= 0 && state.done >= 0 && state.dimension >= 2 &&
                     state.dimension <= 3 && std::ranges::is_sorted(state.first_ids) &&
                     state.first_ids.size() == state.layers.size() + (state.phase == Phase::settling ? 1 : 0);
  if (!valid) refuse_checkpoint("its state contradicts itself");
  return state;
}

/// Rows [begin, begin + count) of a dataset of doubles or ids, `width` numbers each.
template <class T>
std::vector<T> read_rows(hid_t file, const std::string& path, GlobalId total, GlobalId begin, std::size_t count,
                         int width) {
  const auto wide = static_cast<hsize_t>(width);
  std::vector<hsize_t> sizes{static_cast<hsize_t>(total)};
  if (wide > 1) sizes.push_back(wide);
  const disk::h5::Handle dataset = disk::h5::open_dataset(file, path);
  expect_shape(dataset, path, sizes);
  std::vector<T> values(count * wide);
  if (count == 0) return values;
  const disk::h5::Handle there(H5Dget_space(dataset.get()), H5Sclose, "ask for a data space");
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(begin), 0};
  const std::array<hsize_t, 2> block{count, wide};
  disk::h5::check(H5Sselect_hyperslab(there.get(), H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr),
                  "select rows");
  const hsize_t numbers = values.size();
  const disk::h5::Handle here(H5Screate_simple(1, &numbers, nullptr), H5Sclose, "make a data space");
  disk::h5::check(H5Dread(dataset.get(), disk::h5::type_of<T>(), here.get(), there.get(), H5P_DEFAULT, values.data()),
                  "read " + path);
  return values;
}

/// Rows [begin, end) into the store.
void read_particles(hid_t file, GlobalId total, GlobalId begin, GlobalId end, particles::Store& store) {
  const particles::Layout& layout = store.layout();
  const auto count = static_cast<std::size_t>(end - begin);
  const auto read = [&](const char* name, int width) {
    return read_rows<double>(file, std::string("/particles/") + name, total, begin, count, width);
  };
  const auto id = read_rows<std::int64_t>(file, "/particles/id", total, begin, count, 1);
  const auto position = read("position", layout.dimension);
  const auto radius = read("radius", 1);
  const auto velocity = read("velocity", layout.dimension);
  const std::vector<double> spin = layout.rotation ? read("surface_speed", layout.spin_components()) : radius;
  std::vector<double> record(static_cast<std::size_t>(layout.stride));
  const auto copy = [&record](const std::vector<double>& from, std::size_t row, int width, int to) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(row) * width, width, record.begin() + to);
  };
  for (std::size_t k = 0; k < count; ++k) {
    copy(position, k, layout.dimension, layout.position);
    copy(radius, k, 1, layout.radius);
    copy(velocity, k, layout.dimension, layout.velocity);
    if (layout.rotation) copy(spin, k, layout.spin_components(), layout.spin);
    record[static_cast<std::size_t>(layout.curvature)] = 1.0 / radius[k];  // as Store::add() makes it
    store.add_record(id[k], record.data());
  }
}

/// Runs `action`; whatever is thrown becomes "PATH: words" with the code of an unusable checkpoint.
template <class Action>
void explained(const std::string& path, Action&& action) {
  try {
    action();
  } catch (const std::exception& error) {  // bad_alloc too: a damaged size
    throw Error(ExitCode::bad_checkpoint, fmt::format("checkpoint {}: {}", path, error.what()));
  }
}

}  // namespace

RunState read_state(const std::string& path) {
  const disk::h5::Quiet quiet;
  RunState state;
  explained(path, [&] { state = state_in(open_file(path).get()); });
  return state;
}

RunState read_checkpoint(const comm::Comm& comm, const std::string& path, particles::Store& store) {
  const disk::h5::Quiet quiet;
  RunState state;
  std::uint64_t expected = 0;
  comm::agree_on(comm, [&] {
    explained(path, [&] {
      const disk::h5::Handle file = open_file(path);
      state = state_in(file.get());
      expected = read_attribute<std::uint64_t>(file.get(), "particle_digest");
      if (state.dimension != store.layout().dimension || state.rotation != store.layout().rotation) {
        refuse_checkpoint("it is of another dimension, or with and without rotation");
      }
      const disk::IdBlocks blocks{state.count, comm.size()};
      read_particles(file.get(), state.count, blocks.begin(comm.rank()), blocks.begin(comm.rank() + 1), store);
    });
  });
  const auto mine = static_cast<std::int64_t>(particles::digest(store));
  const bool same = static_cast<std::uint64_t>(comm.sum(mine)) == expected;
  if (!same) {
    throw Error(ExitCode::bad_checkpoint,
                fmt::format("checkpoint {}: the digest of its particles is wrong: the file is damaged", path));
  }
  return state;
}

}  // namespace packmpi::pack
