// libFuzzer target for what solvers leave and users write: whatever the bytes, Nastran's printed and punched modes and
// templates, and files of every other kind that rules of extraction read, are either refused with FormatError or give
// numbers that keep their promises.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "fuzz_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/drivers/command/extraction.hpp"
#include "mottle/drivers/command/template_file.hpp"
#include "mottle/formats/nastran/modes.hpp"

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

void check_shapes(const mottle::formats::NamedShapes& shapes) {
  expect(shapes.values.size() > 0 && shapes.values.allFinite());
  expect(static_cast<Eigen::Index>(shapes.names.size()) == shapes.values.rows());
}

/// Rules that read files of no program alone.
void check_extraction(const mottle::test::FuzzFolder& folder) {
  using Format = mottle::drivers::FrequencyRule::Format;
  const std::vector<mottle::drivers::FrequencyRule> rules = {
      {.file = "f", .format = Format::json, .column = "modes.f"},
      {.file = "f", .format = Format::csv, .column = "f"},
      {.file = "f", .format = Format::regex, .pattern = "(?:f *= *)(\\S+)|((x+)+)+$"},
      {.file = "f", .format = Format::column, .after = "FREQ", .line = 2, .column = "2"},
      {.file = "f", .format = Format::calculix}};
  for (const mottle::drivers::FrequencyRule& rule : rules) {
    attempt([&] { return mottle::drivers::extract_modes(folder.path(""), rule, std::nullopt, 1); },
            [](const mottle::drivers::ExtractedModes& modes) { check_values(modes.eigenvalues); });
  }
  using Shapes = mottle::drivers::ShapeRule::Format;
  const mottle::drivers::FrequencyRule one{.file = "one", .column = "1"};
  folder.write("one", "1.0\n");
  for (const mottle::drivers::ShapeRule& rule :
       {mottle::drivers::ShapeRule{.file = "f", .format = Shapes::csv},
        mottle::drivers::ShapeRule{.file = "f", .format = Shapes::column, .after = "MODE"},
        mottle::drivers::ShapeRule{.file = "f", .format = Shapes::calculix}}) {
    attempt([&] { return mottle::drivers::extract_modes(folder.path(""), one, rule, 1); },
            [](const mottle::drivers::ExtractedModes& modes) {
              check_shapes({.names = modes.degree_of_freedom_names, .values = modes.shapes});
            });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  attempt([&] { return mottle::formats::read_f06_eigenvalues(mottle::formats::LineWalker(bytes), "fuzz.f06"); },
          check_values);
  attempt([&] { return mottle::formats::read_f06_shapes(mottle::formats::LineWalker(bytes), "fuzz.f06"); },
          check_shapes);
  attempt([&] { return mottle::formats::read_punch_eigenvalues(mottle::formats::LineWalker(bytes), "fuzz.pch"); },
          check_values);
  attempt([&] { return mottle::formats::read_punch_shapes(mottle::formats::LineWalker(bytes), "fuzz.pch"); },
          check_shapes);
  attempt(
      [&] {
        return mottle::drivers::Template(bytes, "fuzz.in", {"a", "E1", "k:2"}).fill(Eigen::Vector3d(1e308, -2.5, 3.0));
      },
      [&](const std::string& text) { expect(text.size() <= 600 * size); });
  static const mottle::test::FuzzFolder folder;
  folder.write("f", bytes);
  check_extraction(folder);
  return 0;
}
