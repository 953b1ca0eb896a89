// The report's page as npm built it, with a place left for the data.
#pragma once

#include <string_view>

namespace mottle::detail {

/// The whole HTML file; /*MOTTLE_DATA*/ stands in it exactly once, where the JSON belongs.
std::string_view mottle_page_template();

}  // namespace mottle::detail
