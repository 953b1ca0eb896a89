// libFuzzer target for what solvers leave and users write: whatever the bytes, Nastran's printed and punched modes and
// templates are either refused with FormatError or give numbers that keep their promises.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/drivers/template_file.hpp"
#include "mottle/formats/nastran_modes.hpp"

namespace {

void expect(bool claim) {
  if (!claim) std::abort();
}

template <typename Read, typename Check>
void attempt(const Read& read, const Check& check) {
  try {
    check(read());
  } catch (const mottle::FormatError&) {
    return;
  }
}

void check_values(const Eigen::VectorXd& values) {
  expect(values.size() > 0 && values.allFinite());
}

void check_shapes(const mottle::NamedShapes& shapes) {
  expect(shapes.values.size() > 0 && shapes.values.allFinite());
  expect(static_cast<Eigen::Index>(shapes.names.size()) == shapes.values.rows());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  attempt([&] { return mottle::read_f06_eigenvalues(bytes, "fuzz.f06"); }, check_values);
  attempt([&] { return mottle::read_f06_shapes(bytes, "fuzz.f06"); }, check_shapes);
  attempt([&] { return mottle::read_punch_eigenvalues(bytes, "fuzz.pch"); }, check_values);
  attempt([&] { return mottle::read_punch_shapes(bytes, "fuzz.pch"); }, check_shapes);
  attempt(
      [&] {
        return mottle::Template(bytes, "fuzz.in", {"a", "E1", "k:2"}).fill(Eigen::Vector3d(1e308, -2.5, 3.0));
      },
      [&](const std::string& text) { expect(text.size() <= 600 * size); });
  return 0;
}
