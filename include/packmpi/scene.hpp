/// A scene: what is to be packed.
#pragma once
#include <memory>
#include <string>
#include <vector>

namespace packmpi {

namespace input {
struct Input;
}

/// A scene that was read and found valid (doc/input.md). Cheap to copy; never changes.
class Scene {
 public:
  /// Reads a scene file, and the curve or list that it names. `set` changes keys, "key.path=value". Local: each rank
  /// reads for itself. Throws Failure (code 2) with file, line and key. MPI must be running.
  [[nodiscard]] static Scene from_file(const std::string& path, const std::vector<std::string>& set = {});

  /// The same of a text, as if it were that file: its stem names the pack, and files that the text names lie in its
  /// folder. Needs no MPI.
  [[nodiscard]] static Scene from_text(const std::string& text, const std::string& path = "scene.toml",
                                       const std::vector<std::string>& set = {});

  [[nodiscard]] const std::string& name() const noexcept;                  ///< NAME of NAME.hdf
  [[nodiscard]] const std::string& file() const noexcept;                  ///< path, as it was given
  [[nodiscard]] const std::string& effective() const noexcept;             ///< the scene with every default, TOML
  [[nodiscard]] int dimension() const noexcept;                            ///< 2 or 3
  [[nodiscard]] int packs() const noexcept;                                ///< of its [ensemble]; 1: none
  [[nodiscard]] const std::vector<std::string>& remarks() const noexcept;  ///< what was taken how, for people

  [[nodiscard]] const input::Input& input() const noexcept { return *input_; }  ///< for the library itself

 private:
  explicit Scene(std::shared_ptr<const input::Input> input) : input_(std::move(input)) {}
  std::shared_ptr<const input::Input> input_;
};

}  // namespace packmpi
