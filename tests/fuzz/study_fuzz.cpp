// libFuzzer target for the study file: whatever the bytes, read_study throws InvalidInput or gives a study that its own
// text gives again. Nothing is solved or started. Seeds: the studies of examples/.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "fuzz_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "study/tests/shape_size.hpp"

#ifdef MOTTLE_FUZZ_SEARCH  // which is linked with the reader alone
/// Methods are not part of a study's reader: one that takes no options stands for them all.
const std::vector<mottle::updating::MethodEntry>& mottle::updating::updating_methods() {
  const auto make = [](const OptionValues& values, const std::string& where) -> std::unique_ptr<Updater> {
    if (!values.empty()) throw InvalidInput(where + ": is not known");
    return nullptr;
  };
  static const std::vector<MethodEntry> methods = {{"mares", "", {}, make}};
  return methods;
}

/// Nor are the files of tests, which decide whether the size of their shapes is data.
mottle::app::ShapeSize mottle::study::shape_size_of(Study& study) {
  return study.outputs.shape_size;
}
#endif

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const mottle::test::FuzzFolder folder;
  folder.write("study.toml", {reinterpret_cast<const char*>(data), size});
  try {
    const mottle::study::Study study = mottle::study::read_study(folder.path("study.toml"), {});
    folder.write("again.toml", study.text);
    const mottle::study::Study again = mottle::study::read_study(folder.path("again.toml"), {});
    if (again.parameters.list.size() != study.parameters.list.size() || again.text != study.text) std::abort();
    mottle::study::located(study, "update.method", "");
  } catch (const mottle::InvalidInput& error) {
    if (std::string_view(error.what()).size() > 65536) std::abort();
  }
  return 0;
}
