// libFuzzer target for formats/mat: whatever the bytes, parse_mat throws FormatError or gives variables whose sizes are
// those of what they hold. Seeds: tests/formats/mat.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/mat.hpp"

namespace {

void expect(bool claim) {
  if (!claim) std::abort();
}

void check(const std::string& name, const mottle::formats::MatVariable& variable) {
  expect(!name.empty() && variable.sizes.size() >= 2);
  expect(variable.numbers.empty() != variable.texts.empty());
  if (variable.numbers.empty()) return;
  std::size_t count = 1;
  for (const std::size_t size : variable.sizes) count *= size;
  expect(count == variable.numbers.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    for (const auto& [name, variable] : mottle::formats::parse_mat(bytes, "fuzz.mat")) check(name, variable);
  } catch (const mottle::FormatError& error) {
    expect(std::string_view(error.what()).size() < 8192);
  }
  return 0;
}
