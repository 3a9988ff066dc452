#include "cli/info.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/digest.hpp"
#include "base/text.hpp"
#include "base/voids.hpp"
#include "pack/checkpoint.hpp"
#include "pack/pack.hpp"

namespace packmpi::cli {
namespace {

std::string describe(const std::string& path, const pack::RunState& state) {
  const pack::Progress& p = state.progress;
  constexpr std::array<const char*, 3> phases{"before an insertion", "settling", "final stage"};
  return fmt::format(
      "{}: a checkpoint, valid\n  layer {}, {}, step {} ({} of this phase)\n  {} particles in {}D, {}\n  serial {}, by "
      "packmpi "
      "{} ({})\n",
      path, p.first_ids.size(), phases.at(static_cast<std::size_t>(p.now.phase)), p.steps, p.now.done, p.count,
      state.dimension, state.rotation ? "with spin" : "without spin", state.serial, text::printable(state.version),
      text::printable(state.git));
}

// A number of the particle datasets' bits (FNV-1a over their bytes in turn): equal packs have equal ones.
class Bits {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    hash_ = fnv_add(hash_, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = fnv_start;
};

std::string describe(const std::string& path, const pack::PackRows& pack, double phi_bulk) {
  Bits bits;
  bits.add(pack.id);
  bits.add(pack.position);
  bits.add(pack.radius);
  bits.add(pack.velocity);
  bits.add(pack.spin);
  bits.add(pack.layer);
  bits.add(pack.contacts);
  return fmt::format(
      "{}: a pack\n  {} particles in {}D, {} layers, {}\n  solid fraction of the bulk {:.4f}, porosity "
      "{:.4f}, void ratio {:.4f}\n  digest of the particles {:016x}\n",
      path, pack.id.size(), pack.dimension, pack.layer.empty() ? 0 : std::int64_t{pack.layer.back()} + 1,
      pack.spin.empty() ? "without spin" : "with spin", phi_bulk, porosity(phi_bulk), void_ratio(phi_bulk),
      bits.value());
}

std::string describe_here(const std::string& path) {
  if (!std::filesystem::exists(path)) throw Error(ExitCode::io_failure, path + ": there is no such file");
  if (pack::is_pack(path)) return describe(path, pack::read_pack(path), pack::read_origin(path).phi_bulk);
  const comm::Comm alone(MPI_COMM_SELF);
  const pack::RunState state = pack::read_state(path);
  particles::Store store(particles::layout_of(state.dimension, state.rotation));
  return describe(path, pack::read_checkpoint(alone, path, store));
}

}  // namespace

std::string describe_file(const comm::Comm& comm, const std::string& path) {
  std::string words;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    try {
      words = describe_here(path);
    } catch (const Error& error) {  // a checkpoint is unusable for a run; here it is a file like any other
      throw Error(ExitCode::io_failure, error.what());
    }
  });
  return comm.broadcast(0, words);
}

}  // namespace packmpi::cli
