// Specimens that are probably counted more often than they are.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {

/// Sentences on rows of a table that name one specimen in its column "specimen", as repeated tests do, and on specimens
/// that equal an earlier one in each of two or more values, as copies do; of tests that come as modes in all
/// frequencies, damping ratios, and sums and squares of shapes. Rows without values are passed over. They are not
/// refused, since few digits may agree by chance.
std::vector<std::string> repeated_specimens(const TestContents& contents);

}  // namespace mottle::study
