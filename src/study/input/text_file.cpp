#include "mottle/study/input/text_file.hpp"

#include <algorithm>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::study {

std::string read_text_file(const std::filesystem::path& file) {
  std::string bytes = read_file(file);
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t length = utf8_length(std::string_view(bytes).substr(i));
    if (length == 0) {
      const auto line = 1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(i), '\n');
      throw FormatError(file.string(), static_cast<int>(line),
                        fmt::format("holds the byte 0x{:02X}, which is not UTF-8 text; save the file as plain text in "
                                    "UTF-8",
                                    static_cast<unsigned char>(bytes[i])));
    }
    i += length;
  }
  return bytes;
}

}  // namespace mottle::study
