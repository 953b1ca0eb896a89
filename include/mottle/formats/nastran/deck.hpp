// Nastran's deck as text: bytes to cards and case control commands. Knows the three field formats, continuation lines
// and INCLUDE; what a card means is left to nastran_model.hpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// One bulk data card with its continuation lines. The views refer to the deck's text.
struct BulkCard {
  std::string_view name;                     ///< in capitals, without '*'
  std::span<const std::string_view> fields;  ///< data fields, trimmed, in capitals; eight a line: the n-th one (from 1)
                                             ///< of line l is fields[8 l + n - 1]; blank ones at the end are left out
  int file = 0;                              ///< index into NastranDeck::files
  int line = 0;                              ///< of its first line, from 1
};

/// One command of the case control section: "SPC = 2".
struct CaseCommand {
  std::string name;   ///< in capitals, as written (may be abbreviated to four letters), without "(...)"
  std::string value;  ///< behind '=', trimmed; for PARAM "NAME,VALUE"
  int subcase = -1;   ///< index into NastranDeck::subcases; -1: above the first one
  int file = 0;
  int line = 0;
};

/// A whole deck, included files and all.
struct NastranDeck {
  std::vector<std::string> files;  ///< main file first, then in the order of reading
  std::vector<BulkCard> cards;     ///< in the order of reading
  std::vector<CaseCommand> case_control;
  std::vector<int> subcases;       ///< their ids, in order
  std::string solution;            ///< of SOL, in capitals: "103", "SEMODES"; empty where there is none
  std::vector<std::string> notes;  ///< what was read in a way that its author may not have meant

  /// The text that the views of `cards` refer to; shared, so that a deck may be copied.
  struct Text;
  std::shared_ptr<const Text> text;

  /// The command that holds in a subcase (index; -1: the first one): the subcase's own, else the one above all
  /// subcases, the last one where several stand. nullptr where there is none.
  const CaseCommand* find_command(std::string_view name, int subcase = -1) const;
  /// "file:line" of a card.
  std::string location_of(const BulkCard& card) const;
};

/// A file that an INCLUDE statement names.
struct IncludedFile {
  std::string name;  ///< as messages show it; the same file has the same name every time
  std::string bytes;
};

/// Finds the file that `written` names in the file `from` (a name given earlier); nothing where there is none.
using IncludeResolver = std::function<std::optional<IncludedFile>(const std::string& written, const std::string& from)>;

/// Reads a deck and the files that it includes: each is looked for beside the including file, then beside the main one
/// (backslashes count as slashes; letter case is forgiven where exactly one file fits).
///
/// Small, large and free fields in any mixture, tabs, comments, continuation lines by position or by label, '=' lines
/// that repeat the card above with changes; a deck without CEND and BEGIN BULK is bulk data alone. Reading ends at
/// ENDDATA.
///
/// @throws FormatError   with file and line: an unknown field layout, a continuation without a card, an include that is
///                       missing or goes round in circles, '/' (delete), '=' behind a card of several lines,
///                       superelements, more than 2 GB, 1,000 includes, 32 levels, 65,536 characters a line or a
///                       million lines a card
/// @throws InvalidInput  the main file is missing or unreadable
NastranDeck read_nastran_deck(const std::filesystem::path& file);

/// The same from bytes; `name` stands for the main file in messages.
NastranDeck parse_nastran_deck(std::string bytes, const std::string& name, const IncludeResolver& resolve = {});

}  // namespace mottle::formats
