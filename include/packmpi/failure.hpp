/// What the functions of the library throw.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>

namespace packmpi {

/// Why there is no result. what() is one line: what is wrong and what to do. Of a collective function it is thrown on
/// every rank, with the same words. Where the scene is to blame, it says where.
class Failure : public std::runtime_error {
 public:
  Failure(int code, const std::string& words, std::string file = {}, std::int64_t line = 0, std::string key = {})
      : std::runtime_error(words), code_(code), file_(std::move(file)), line_(line), key_(std::move(key)) {}

  /// As the program's exit codes: 2 a scene or a wish that is wrong, 4 numerical failure, 5 a file, 6 no checkpoint, 75
  /// stopped early.
  [[nodiscard]] int code() const noexcept { return code_; }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }  ///< the scene's; "": it is not to blame
  [[nodiscard]] std::int64_t line() const noexcept { return line_; }        ///< of that file, from 1; 0: of no line
  [[nodiscard]] const std::string& key() const noexcept { return key_; }    ///< "particles.radius.mean"; "": none

 private:
  int code_;
  std::string file_;
  std::int64_t line_;
  std::string key_;
};

}  // namespace packmpi
