// libFuzzer target for report: whatever result.json, modes.json, tests.csv and clouds.csv hold (divided by lines
// "$FILE"), write_report refuses them with InvalidInput or makes a page with them. Seeds: tests/fuzz/report.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "fuzz_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/report/report.hpp"
#include "mottle_page.hpp"

// The page around the data is built by npm; here it is the place of the data alone.
std::string_view mottle::detail::mottle_page_template() {
  return "/*MOTTLE_DATA*/";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const mottle::test::FuzzFolder folder;
  std::string_view bytes(reinterpret_cast<const char*>(data), size);
  constexpr std::string_view k_border = "$FILE\n";
  for (const char* name : {"result.json", "modes.json", "tests.csv", "clouds.csv"}) {
    const std::size_t border = bytes.find(k_border);
    folder.write(name, bytes.substr(0, border));
    bytes.remove_prefix(border == std::string_view::npos ? bytes.size() : border + k_border.size());
  }
  try {
    mottle::report::write_report(folder.path(""));
    if (std::filesystem::file_size(folder.path("report.html")) == 0) std::abort();
  } catch (const mottle::InvalidInput& error) {
    if (std::string_view(error.what()).size() > 8192) std::abort();
  }
  return 0;
}
