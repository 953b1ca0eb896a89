// Small helpers for messages: lists of names and the known name nearest to a mistyped one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mottle {

/// "a, b, c".
std::string join(const std::vector<std::string>& parts, std::string_view separator = ", ");

/// Number of single-character insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`.
/// Source: [Damerau1964], restricted to non-overlapping swaps.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `name` by edit distance, or "" where none is near enough to be meant
/// (more than a third of the letters differ, at least two).
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "'stifness' is not known here; did you mean 'stiffness'? Known: a, b, c".
std::string unknown_name_message(std::string_view what, std::string_view name,
                                 const std::vector<std::string>& candidates);

/// Whether `name` fits `pattern`, in which * stands for any characters (also none) and ? for any one.
bool matches_pattern(std::string_view name, std::string_view pattern);

/// The text with a to z as A to Z; other bytes stay.
std::string capitals(std::string_view text);

/// Levels of nesting that are read of a JSON file: those of solvers and of Mottle have a handful.
inline constexpr int k_deepest_json = 100;

/// Whether objects and lists stand in one another deeper than `levels`: what walks the parsed text would run out of
/// stack. Of a text that is not JSON the answer means nothing.
bool nests_deeper_than(std::string_view json, int levels);

/// Shortest decimal text that reads back as the same double.
std::string number_text(double value);

/// Reads one decimal number that fills `text` (surrounding blanks allowed); false where it does not.
bool parse_number(std::string_view text, double& value);

}  // namespace mottle
