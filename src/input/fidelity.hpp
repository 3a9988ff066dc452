/// What `fidelity` stands for: values for other keys where the scene gives none.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "document/document.hpp"
#include "input/input.hpp"

namespace packmpi::input {

using document::Document;

/// A key and the value, as TOML, that a preset gives it.
struct PresetValue {
  std::string_view path;
  std::string value;
};

/// The values of the preset in.fidelity for a scene with this container, these layers, gravity and modulus. Numbers
/// are rounded to three digits. Local. Throws Error(bad_input) where there is no free fall to measure times by.
[[nodiscard]] std::vector<PresetValue> preset(const Input& in);

/// The value, as TOML, of a key that decides which other keys belong to the scene, where the document names a preset
/// and not the key: presets but "paper" have friction with memory.
[[nodiscard]] std::optional<std::string_view> preset_law(const Document& document, std::string_view path,
                                                         const Input& in);

/// Gives the keys of the preset that the document does not have their values; only if the document names a preset.
void apply_preset(const Document& document, Input& in);

/// For a reader: what the preset set, and where the scene has another value. Lines "key = value", "key = value (the
/// preset: value)".
[[nodiscard]] std::vector<std::string> preset_in_use(Input in);

/// Where the scene has another value than its preset.
struct PresetOverrides {
  std::vector<std::string> words;  ///< "layers.duration = 1 (the preset: 0.775)"
  Input as_preset;                 ///< the scene with the preset's values
};
[[nodiscard]] PresetOverrides preset_overrides(Input in);

}  // namespace packmpi::input
