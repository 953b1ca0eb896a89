// Result as JSON -> one HTML file that opens without network. Draws nothing itself: the page does (web/).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "mottle/layers.hpp"

namespace mottle::report {

/// The report: the built page with `data_json` in its data element.
///
/// Every `<` of the data becomes \u003c, which JSON reads as the same character, so that no text in it (a study's
/// title, a solver's message) can end the element and be taken as markup.
///
/// @param data_json  one valid JSON document in UTF-8: {"result": ..., "tests": ..., "clouds": ...}
/// @return           the complete HTML file
std::string render_page(std::string_view data_json);

/// Whether the file is a page of this program, of whatever version, whose data is of that kind ("compare").
bool is_page_of(const std::filesystem::path& file, const std::string& kind);

}  // namespace mottle::report
