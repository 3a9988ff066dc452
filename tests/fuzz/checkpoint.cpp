/// The readers of checkpoints and packs with damaged files: refused with an error, or read as they were written. The
/// bytes are a list of changes to a valid file, which is made when the fuzzer starts: see Damage. Or the change is to
/// what a checkpoint says and all its digests are made to agree, as no damage would: see Forgery.
#include "pack/checkpoint.hpp"

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include "base/digest.hpp"
#include "disk/seal.hpp"
#include "fuzz/demand.hpp"
#include "pack/pack.hpp"
#include "pack/run_state.hpp"

namespace packmpi::fuzz {
namespace {

constexpr std::size_t particle_count = 9;

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

particles::Store some_particles(int dimension, bool rotation, bool mixture) {
  particles::Store store(particles::layout_of(dimension, rotation, mixture));
  for (std::size_t k = 0; k < particle_count; ++k) {
    const double x = 0.1 * static_cast<double>(k + 1);
    store.add(static_cast<GlobalId>(k), {x, x * x, dimension == 3 ? 1.0 - x : 0.0}, 0.01 + 0.001 * x, {-x, x, 0.0},
              {0.0, 0.0, 3.0 * x});
    if (mixture) store.set_substance(static_cast<LocalIndex>(k), {k % 5 < 3 ? 0.0 : 1.0, x});
  }
  return store;
}

/// With rotation: contacts of particles with each other and with walls.
pack::Histories some_histories(int dimension, bool rotation) {
  pack::Histories all{.features = {.dimension = dimension, .memory = rotation, .rolling = rotation}, .rows = {}};
  for (GlobalId id = 1; rotation && id < static_cast<GlobalId>(particle_count); ++id) {
    all.rows.push_back({.holder = id, .other = id % 3 == 0 ? -1 : id - 1, .values = {1e-5, -2e-5, 3e-6, 4e-7}});
  }
  return all;
}

report::LayerRow some_layer() {
  return {.inserted = particle_count,
          .total = particle_count,
          .attempts = 20,
          .achieved_fraction = 0.1,
          .steps = 7,
          .stop_reason = "duration"};
}

/// The records of all particles and the ids, as bytes.
std::string bytes_of(const particles::Store& store) {
  std::string bytes;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const GlobalId id = store.ids()[static_cast<std::size_t>(i)];
    bytes.append(reinterpret_cast<const char*>(&id), sizeof id);
    bytes.append(reinterpret_cast<const char*>(store.record(i)),
                 static_cast<std::size_t>(store.layout().used_doubles()) * sizeof(double));
  }
  return bytes;
}

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  bytes += '|';
}

std::string bytes_of(const pack::Histories& contacts) {
  std::string bytes = std::to_string(contacts.features.memory) + std::to_string(contacts.features.rolling);
  append(bytes, contacts.rows);
  return bytes;
}

std::string bytes_of(const pack::PackRows& rows) {
  std::string bytes = std::to_string(rows.dimension);
  append(bytes, rows.id);
  append(bytes, rows.position);
  append(bytes, rows.velocity);
  append(bytes, rows.spin);
  append(bytes, rows.radius);
  append(bytes, rows.layer);
  append(bytes, rows.contacts);
  append(bytes, rows.component);
  return bytes;
}

/// A valid file, and what its reader must find in it or in a damaged one.
struct Sample {
  bool pack = false;
  int dimension = 3;
  bool rotation = true;
  bool mixture = false;  ///< of two components
  std::string bytes;     ///< of the file
  std::string contents;  ///< as read_contents() gives them
  disk::Seal seal;
  pack::RunState state;  ///< of a checkpoint
};

/// The one file, in a folder of its own below TMPDIR, which had better be in memory. A crash leaves it behind.
class File {
 public:
  File() { demand(mkdtemp(folder_.data()) != nullptr, "no folder"); }
  ~File() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] std::string path() const { return folder_ + "/file.hdf"; }
  void put(const std::string& bytes) const {
    std::ofstream file(path(), std::ios::binary | std::ios::trunc);
    file << bytes;
    file.close();
    demand(file.good(), "cannot write");
  }

 private:
  std::string folder_ = (std::filesystem::temp_directory_path() / "packmpi-fuzz-XXXXXX").string();
};

/// Everything that the program reads of the file. Throws Error.
std::string read_contents(const comm::Comm& alone, const Sample& sample, const std::string& path) {
  if (sample.pack) {
    (void)pack::is_pack(path);
    pack::check_pack(alone, path);
    const pack::PackSlice first = pack::read_slice(path, 0, 2);
    return bytes_of(pack::read_pack(path)) + bytes_of(first.rows) + first.scene;
  }
  const pack::RunState alike = pack::read_state(path);
  particles::Store store(particles::layout_of(sample.dimension, sample.rotation, sample.mixture));
  pack::Histories contacts;
  const pack::RunState state = pack::read_checkpoint(alone, path, store, &contacts);
  demand(pack::to_text(state) == pack::to_text(alike), "two readers find two states");
  return pack::to_text(state) + state.effective_input + bytes_of(store) + bytes_of(contacts);
}

void write_sample(const comm::Comm& alone, const Sample& sample, const std::string& path) {
  const particles::Store store = some_particles(sample.dimension, sample.rotation, sample.mixture);
  const std::string scene = "seed = 7\n[container]\nsize = [1.0, 1.0]\n";
  if (sample.pack) {
    const std::vector<std::int32_t> numbers(particle_count, 1);
    const std::vector<pack::ContactRow> contacts{{.first = 0, .second = 1, .overlap = 0.001, .force = {1.0, 2.0, 3.0}}};
    report::RunRecord record;
    record.effective_input = scene;
    record.dimension = sample.dimension;
    record.layers = {some_layer()};
    pack::write_pack(alone, path, {&store, numbers, numbers, sample.rotation ? &contacts : nullptr}, record);
    return;
  }
  pack::RunState state;
  state.serial = 3;
  state.effective_input = scene;
  state.version = "0.1.0";
  state.dimension = sample.dimension;
  state.rotation = sample.rotation;
  state.progress.first_ids = {0, 5};
  state.progress.count = particle_count;
  state.progress.steps = 12;
  state.progress.layers = {some_layer()};
  if (sample.mixture) {
    state.progress.mixing = {.on = true,
                             .counts = {3, 2, 3, 1},
                             .drawn = {6, 3},
                             .units = {6000, 2000},
                             .wanted = {6100, 1900},
                             .extent = 0.01,
                             .stratum = 1,
                             .stratum_extent = 0.004,
                             .stratum_layers = 1,
                             .strata = {0, 1}};
  }
  state.progress.now.phase = pack::Phase::settling;
  state.progress.now.row = some_layer();
  const std::array<const particles::Store*, 1> stores{&store};
  const pack::Histories contacts = some_histories(sample.dimension, sample.rotation);
  pack::write_checkpoint(alone, path, stores, state, contacts.here());
}

class World {
 public:
  World() {
    for (const auto& [pack, rotation, mixture] :
         {std::tuple(false, true, false), std::tuple(false, false, false), std::tuple(true, true, false),
          std::tuple(true, false, false), std::tuple(false, true, true), std::tuple(true, true, true)}) {
      Sample sample{.pack = pack,
                    .dimension = rotation ? 3 : 2,
                    .rotation = rotation,
                    .mixture = mixture,
                    .bytes = {},
                    .contents = {},
                    .seal = {},
                    .state = {}};
      write_sample(alone_, sample, path_);
      sample.bytes = bytes_of(path_);
      sample.contents = read_contents(alone_, sample, path_);
      sample.seal = disk::check_frame(path_);
      if (!pack) sample.state = pack::read_state(path_);
      samples_.push_back(sample);
    }
  }
  [[nodiscard]] const Sample& sample(std::size_t k) const { return samples_[k % samples_.size()]; }

  /// The reader's answer to `bytes` in the place of the sample's, which may be refused or give `contents`.
  void read(const Sample& sample, const std::string& bytes, const std::string& contents) const {
    file_.put(bytes);
    try {
      demand(read_contents(alone_, sample, path_) == contents, "other contents are accepted");
    } catch (const Error& error) {
      const std::string words = error.what();
      demand(bytes != sample.bytes, "a valid file is refused: " + words);
      demand(error.code() == (sample.pack ? ExitCode::io_failure : ExitCode::bad_checkpoint), "wrong code: " + words);
      demand(words.find(path_) != std::string::npos, "no path: " + words);
    }
  }

 private:
  comm::Comm alone_{MPI_COMM_SELF};
  File file_;
  std::string path_ = file_.path();
  std::vector<Sample> samples_;
};

World* world = nullptr;

/// The fuzzer's bytes, taken from the front; zeros when they are used up.
class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  [[nodiscard]] bool empty() const { return left_ == 0; }
  std::size_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  std::size_t word() {
    const std::size_t low = byte();
    return low + 256 * byte();
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// One change to a file, in place. The kinds: bytes written over, a bit turned, the end cut off, bytes copied from
/// another place or another file, bytes added, a number of the kind that breaks arithmetic.
class Damage {
 public:
  Damage(Source& source, const Sample& other) : source_(&source), other_(&other.bytes) {}
  void apply(std::string& bytes) {
    const std::size_t kind = source_->byte() % 7;
    const std::size_t at = bytes.empty() ? 0 : source_->word() % bytes.size();
    switch (kind) {
      case 0:
        return write_over(bytes, at);
      case 1:
        if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << source_->byte() % 8));
        return;
      case 2:
        return bytes.resize(at);
      case 3:
        return copy(bytes, std::string(bytes), at);
      case 4:
        return copy(bytes, *other_, at);
      case 5:
        bytes.append(source_->byte(), static_cast<char>(source_->byte()));
        return;
      default:
        return write_number(bytes, at);
    }
  }

 private:
  void write_over(std::string& bytes, std::size_t at) {
    const std::size_t count = std::min(source_->byte() % 16, bytes.size() - at);
    for (std::size_t k = 0; k < count; ++k) bytes[at + k] = static_cast<char>(source_->byte());
  }
  void copy(std::string& bytes, const std::string& from, std::size_t at) {
    if (from.empty() || bytes.empty()) return;
    const std::size_t begin = source_->word() % from.size();
    const std::size_t count = std::min({source_->word(), from.size() - begin, bytes.size() - at});
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(begin), count,
                bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  void write_number(std::string& bytes, std::size_t at) {
    constexpr std::array<std::uint64_t, 8> numbers{
        0, 1, UINT64_MAX, INT64_MAX, INT32_MAX, 0xffff, std::uint64_t{1} << 40U, 0x7ff8000000000000};
    const std::uint64_t number = numbers.at(source_->byte() % numbers.size());
    const std::size_t count = std::min(std::size_t{1} << source_->byte() % 4, bytes.size() - at);
    std::memcpy(bytes.data() + at, &number, count);
  }

  Source* source_;
  const std::string* other_;
};

/// The bytes of `number` as they are in a file.
std::string raw(std::uint64_t number) { return {reinterpret_cast<const char*>(&number), sizeof number}; }

void replace(std::string& bytes, const std::string& what, const std::string& with) {
  const std::size_t at = bytes.find(what);
  demand(at != std::string::npos && what.size() == with.size(), "the sample is not what it should be");
  bytes.replace(at, with.size(), with);
}

/// A checkpoint of another state of the same length, with the digests that belong to it.
class Forgery {
 public:
  Forgery(Source& source, const Sample& sample) : sample_(&sample), text_(pack::to_text(sample.state)) {
    const std::string before = text_;
    Damage damage(source, sample);
    while (!source.empty()) damage.apply(text_);
    text_.resize(before.size(), ' ');
    bytes_ = sample.bytes.substr(0, static_cast<std::size_t>(sample.seal.end));
    const std::string& scene = sample.state.effective_input;
    replace(bytes_, before, text_);
    replace(bytes_, raw(fnv_add(fnv_start, before + scene)), raw(fnv_add(fnv_start, text_ + scene)));
    disk::Seal seal = sample.seal;
    seal.frame = disk::frame_digest(seal, [this](std::int64_t begin, std::int64_t size) {
      return bytes_.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(size));
    });
    bytes_ += disk::to_bytes(seal);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  /// What its reader finds unless it refuses: the words of the state as they stand there.
  [[nodiscard]] std::string contents() const {
    return text_ + sample_->contents.substr(pack::to_text(sample_->state).size());
  }

 private:
  const Sample* sample_;
  std::string text_, bytes_;
};

void try_bytes(Source source) {
  const std::size_t which = source.byte();
  const Sample& sample = world->sample(which);
  if (!sample.pack && which >= 128) {
    const Forgery forgery(source, sample);
    world->read(sample, forgery.bytes(), forgery.contents());
    return;
  }
  Damage damage(source, world->sample(which / 6));
  std::string bytes = sample.bytes;
  while (!source.empty()) damage.apply(bytes);
  world->read(sample, bytes, sample.contents);
}

void finish() {
  delete world;
  MPI_Finalize();
}

}  // namespace
}  // namespace packmpi::fuzz

// NOLINTBEGIN(readability-identifier-naming): libFuzzer's names
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  setenv("OMPI_MCA_opal_signal", "", 1);  // a crash is the fuzzer's to tell
  MPI_Init(argc, argv);
  packmpi::fuzz::world = new packmpi::fuzz::World;
  std::atexit(packmpi::fuzz::finish);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  packmpi::fuzz::within_a_second([&] { packmpi::fuzz::try_bytes(packmpi::fuzz::Source(data, size)); });
  return 0;
}
// NOLINTEND(readability-identifier-naming)
