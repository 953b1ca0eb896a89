// The words of a Gmsh file, one after the other across its lines.
#pragma once

#include <string>
#include <string_view>

#include "mottle/layers.hpp"

namespace mottle::formats::gmsh {

class Words {
 public:
  Words(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  /// The next word; empty at the end.
  std::string_view next();
  /// The next word, of which there is one.
  std::string_view need(const char* what);
  /// A whole number in `lowest`..`highest`.
  int whole(const char* what, int lowest, int highest);
  /// A tag: a whole number from 1.
  int tag(const char* what);
  /// How many things follow that take at least two bytes each.
  std::size_t count(const char* what);
  double real(const char* what);
  /// Text in quotes.
  std::string quoted(const char* what);
  void skip(std::size_t words, const char* what);
  /// Skips to the line behind "$End..." of a section.
  void skip_section(std::string_view name);
  /// Takes "$End..." of a section.
  void end_section(std::string_view name);

  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view bytes_;
  std::string file_;
  std::size_t at_ = 0;
  int line_ = 1;  // of the word that was read last
};

}  // namespace mottle::formats::gmsh
