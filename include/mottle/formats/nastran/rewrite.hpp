// A Nastran deck with other numbers in it: all lines stay as they are but for the fields that change.
#pragma once

#include <string>
#include <vector>

#include "mottle/formats/nastran/model.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// A number of a card by the name of its CardField, and its new value.
struct FieldChange {
  std::string card;  ///< "MAT1", in capitals
  int id = 0;
  std::string name;  ///< "E"
  double value = 0.0;
};

struct RewrittenFile {
  std::string name;  ///< as in NastranDeck::files
  std::string bytes;
};

struct RewrittenDeck {
  std::vector<RewrittenFile> files;  ///< all that the deck consists of, the main one first
  double rounding = 0.0;             ///< largest relative difference of a value as written from the one wanted
};

/// The deck's files with new values in the fields of their own lines, in as many digits as the field is wide (8 or 16
/// characters; 8 hold five digits or more). The result is read again: it holds if these numbers alone have changed.
///
/// @throws InvalidInput  a number that is not on a card of its own (computed from others, repeated by '=', in a line
///                       with tabs), or that stands more than once
RewrittenDeck rewrite_nastran_deck(const std::filesystem::path& file, const NastranOptions& options,
                                   const std::vector<FieldChange>& changes);

/// The text of at most `width` characters that Nastran reads as the number nearest to `value`: "7.0+10", ".00125".
std::string nastran_real(double value, int width);

}  // namespace mottle::formats
