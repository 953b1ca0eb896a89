// A CalculiX input deck as lines, and the numbers in it that a parameter may set.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// A deck with what it includes.
struct CalculixDeck {
  struct Line {
    std::string text;
    int file = 0;    ///< into `files`
    int number = 0;  ///< from 1
  };

  /// An *INCLUDE; its line is not among `lines`.
  struct Include {
    Line line;
    std::size_t begin = 0, length = 0;  ///< of the file's name in the line
    int included = 0;                   ///< into `files`
  };

  std::vector<Line> lines;
  std::vector<std::string> files;  ///< the deck itself first; one that is included twice stands here twice
  std::vector<Include> includes = {};

  /// "plate.inp:12" of a line.
  std::string where(std::size_t line) const;
};

/// Throws InvalidInput: a file that is missing; FormatError: includes in a circle or more than 100.
CalculixDeck read_calculix_deck(const std::filesystem::path& file);

/// A number's position in a deck, and its value.
struct CalculixNumber {
  std::size_t line = 0, begin = 0, length = 0;
  double value = 0.0;           ///< nan of a placeholder
  bool is_placeholder = false;  ///< {{name}}
  int temperatures = 1;         ///< at which the card gives this number
};

/// The numbers that a target names:
///
///   *ELASTIC:MATERIAL:E          Young's modulus;  :NU Poisson's ratio; of other types :E1 :G12 ... (ENGINEERING
///                                CONSTANTS), :D1111 :D1122 ... (ORTHO, ANISO)
///   *DENSITY:MATERIAL            density
///   *SPRING:ELSET                stiffness of linear springs;  *MASS:ELSET  mass
///   *SHELL SECTION:ELSET:T       thickness
///   {{name}}                     wherever that stands in the deck
///
/// Inside of a part of an Abaqus deck ELSET is PART.ELSET, or ELSET where only one part has it.
///
/// Keywords and names in any case. Throws InvalidInput: a target that is none of these or not in the deck (with what
/// the deck has); FormatError: a card whose number cannot be moved (nonlinear, of another type). Numbers that depend on
/// temperature are found at each.
std::vector<CalculixNumber> find_calculix_numbers(const CalculixDeck& deck, const std::string& target);

/// Targets of all numbers of the deck that a parameter can set, in the deck's order: moduli, densities, linear springs,
/// masses and thicknesses that are not 0. Poisson's ratios are left out.
std::vector<std::string> list_calculix_targets(const CalculixDeck& deck);

/// The field of a target: "E", "NU", "T", or "" where the keyword has a single number; empty too for {{name}}.
/// Throws nothing: a target of another form gives "".
std::string calculix_field(const std::string& target);

/// A number and its new value.
struct CalculixChange {
  CalculixNumber number;
  double value = 0.0;
};

/// The deck with other numbers and one step, the first *FREQUENCY with SOLVER=MATRIXSTORAGE and its boundary
/// conditions. Parts and other cards of Abaqus are put into those of CalculiX, here and below. Numbers have at most 20
/// characters, which is what CalculiX reads. Not for decks with needs_earlier_steps().
///
/// Throws FormatError: steps without *FREQUENCY, a placeholder that nothing fills.
std::string matrix_storage_deck(const CalculixDeck& deck, const std::vector<CalculixChange>& changes);

/// The same deck with a *FREQUENCY for so many modes and no limits of their frequencies.
std::string modes_deck(const CalculixDeck& deck, const std::vector<CalculixChange>& changes, int modes);

/// The model alone, with a step that solves nothing: what CalculiX says of it is about its cards. Placeholders stay.
std::string deck_without_steps(const CalculixDeck& deck);

/// A number and the text that replaces it.
struct CalculixReplacement {
  CalculixNumber number;
  std::string text;
};

/// The deck with texts in place of numbers and without its comments; its lines keep their numbers where nothing is
/// included.
///
/// Throws FormatError: no step *FREQUENCY.
std::string deck_with_replacements(const CalculixDeck& deck, const std::vector<CalculixReplacement>& replacements);

/// "1e6" -> "1.e6": CalculiX takes a spring's stiffness without a point for degrees of freedom.
std::string with_decimal_point(std::string number);

/// A file of a deck that is written elsewhere.
struct CalculixFile {
  std::filesystem::path name;  ///< relative to the new folder
  std::string bytes;
};

/// The deck and each file that it includes, byte by byte as their author wrote them but for texts in place of numbers
/// and names of included files that lie outside of the deck's folder, or are absolute: these come into the new folder
/// too.
///
/// Throws FormatError: a file that is included twice would need two texts for one number, or was changed since the deck
/// was read; InvalidInput: it is gone.
std::vector<CalculixFile> deck_files_with_replacements(const CalculixDeck& deck,
                                                       const std::vector<CalculixReplacement>& replacements);

/// Why the first step *FREQUENCY cannot stand alone: it is a PERTURBATION of a preloaded state, or has a *BOUNDARY of a
/// step before it; empty where it can.
std::string needs_earlier_steps(const CalculixDeck& deck);

/// Sentence on the steps that are not used; empty where all are.
std::string left_out_steps(const CalculixDeck& deck);

/// Sentences on elements that are not what their name promises; of a deck with Abaqus' cards also on what was left out
/// and on the numbers of its instances.
std::vector<std::string> element_notes(const CalculixDeck& deck);

/// Whether the deck asks for displacements in .frd: *NODE FILE (or *NODE OUTPUT) with U.
bool writes_displacements(const CalculixDeck& deck);

}  // namespace mottle::formats
