// libFuzzer target for formats/uff: whatever the bytes, parse_uff and what is made of it either throw FormatError or
// give data that keep their promises and survive being written and read again.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/formats/uff/frames.hpp"
#include "mottle/formats/uff/uff.hpp"

namespace {

void expect(bool claim) {
  if (!claim) std::abort();
}

void check(const mottle::formats::UffFile& file) {
  for (const mottle::formats::UffShape& shape : file.shapes) {
    expect(shape.values.rows() == static_cast<Eigen::Index>(shape.nodes.size()));
    expect(shape.values.cols() == 3 || shape.values.cols() == 6);
    expect(shape.values.allFinite());
  }
  for (const mottle::formats::UffFunction& function : file.functions) {
    expect(function.values.size() > 0 && function.values.size() == function.abscissa.size());
    expect(function.values.allFinite());
  }
  for (const mottle::formats::UffCoordinateSystem& system : file.systems) {
    expect((system.system.axes.transpose() * system.system.axes).isIdentity(1e-3));
  }
}

void check_meaning(mottle::formats::UffFile file) {
  mottle::formats::convert_to_si(file);
  const mottle::formats::UffFrames frames(file);
  for (const mottle::formats::UffNode& node : file.nodes) frames.directions_at(node.id);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  mottle::formats::UffFile file;
  try {
    file = mottle::formats::parse_uff(bytes, "fuzz.uff");
  } catch (const mottle::FormatError&) {
    return 0;
  }
  check(file);
  try {
    check_meaning(file);
  } catch (const mottle::FormatError&) {
    return 0;
  }
  // A title that is a mark, or a system within another, cannot be written; nothing else may be refused.
  for (mottle::formats::UffShape& shape : file.shapes) shape.titles.fill("");
  for (mottle::formats::UffFunction& function : file.functions) function.titles.fill("");
  file.header.reset();
  file.systems.clear();
  std::erase_if(file.functions,
                [](const mottle::formats::UffFunction& function) {  // an abscissa is written in single precision
                  return function.abscissa.cwiseAbs().maxCoeff() > 1e38;
                });
  if (file.shapes.empty() && file.functions.empty() && file.nodes.empty()) return 0;  // no dataset is no file
  for (const int dataset : {55, 2414}) {
    const mottle::formats::UffFile again =
        mottle::formats::parse_uff(mottle::formats::format_uff(file, {.shapes = dataset}), "again.uff");
    expect(again.shapes.size() == file.shapes.size() && again.functions.size() == file.functions.size() &&
           again.nodes.size() == file.nodes.size());
    for (std::size_t k = 0; k < file.shapes.size(); ++k) expect(again.shapes[k].nodes == file.shapes[k].nodes);
    for (std::size_t k = 0; k < file.functions.size(); ++k) {
      expect(again.functions[k].values.size() == file.functions[k].values.size());
    }
  }
  return 0;
}
