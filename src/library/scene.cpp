// Scenes that were read: include/packmpi/scene.hpp.
#include "packmpi/scene.hpp"

#include "comm/comm.hpp"
#include "input/read.hpp"
#include "library/failure.hpp"

namespace packmpi {
namespace {

template <class Read>
std::shared_ptr<const input::Input> read_here(const std::string& path, Read&& read) {
  try {
    return std::make_shared<const input::Input>(read());
  } catch (...) {
    throw library::failure_of(comm::caught(ExitCode::bad_input), path);
  }
}

}  // namespace

Scene Scene::from_file(const std::string& path, const std::vector<std::string>& set) {
  return Scene(read_here(path, [&] { return input::read(comm::Comm(MPI_COMM_SELF), path, {set}); }));
}

Scene Scene::from_text(const std::string& text, const std::string& path, const std::vector<std::string>& set) {
  return Scene(read_here(path, [&] { return input::parse(text, path, {set}, input::named_files(text, path, {set})); }));
}

const std::string& Scene::name() const noexcept { return input_->name; }
const std::string& Scene::file() const noexcept { return input_->file; }
const std::string& Scene::effective() const noexcept { return input_->effective; }
int Scene::dimension() const noexcept { return input_->container.dimension; }
int Scene::packs() const noexcept { return input_->ensemble.sets * input_->ensemble.packs; }
const std::vector<std::string>& Scene::remarks() const noexcept { return input_->remarks; }

}  // namespace packmpi
