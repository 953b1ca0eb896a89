// Words of a shell's command line.
#pragma once

#include <string>

namespace mottle {

/// A word of a shell's command line, in quotes where it needs them.
std::string shell_word(const std::string& word);

}  // namespace mottle
