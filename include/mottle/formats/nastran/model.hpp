// Nastran's cards as a finite-element model: ids become indices, coordinates basic ones, sets the selected ones. Which
// physics a number means is left to the fem layer.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/formats/nastran/deck.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

struct NastranOptions {
  std::set<std::string> ignore_cards = {};    ///< names in capitals; such cards (and K2GG, NSM... of the case control
                                              ///< section) are skipped, with a note
  std::optional<int> subcase = std::nullopt;  ///< id; without it the first one that has a METHOD or ANALYSIS =
                                              ///< MODES of its own, else the first
};

struct NastranModel {
  FiniteElementModel model;
  std::vector<std::string> notes;             ///< what was left out, assumed or repaired, one sentence each
  std::map<std::string, int> element_counts;  ///< card name -> number of elements
  std::vector<std::string> files;             ///< every file that was read, the main one first
};

/// The finite-element model that a deck describes.
///
/// Read are the cards that docs/howto/nastran.md lists. Cards that do not change the stiffness and mass matrix (loads,
/// tables, output) are skipped.
///
/// SPC, MPC and METHOD are taken from the case control section; where there is none and the deck holds one set, that
/// one is taken, with a note.
///
/// Every number that a parameter may act on becomes a CardField named as in the Quick Reference Guide; that page lists
/// them too. A number that the card leaves blank has no field (MAT1 RHO too).
///
/// @throws FormatError  with file and line: a card that breaks the format's rules, names what does not exist, or is
///                      not supported although it changes the model; `ignore_cards` goes on without the latter
NastranModel read_nastran_model(const std::filesystem::path& file, const NastranOptions& options = {});

/// The same from a deck in memory.
NastranModel build_nastran_model(const NastranDeck& deck, const NastranOptions& options = {});

/// Whether a number of a deck is one that models are usually wrong in: moduli, densities, dimensions, springs, masses.
bool is_design_number(const CardField& field);

}  // namespace mottle::formats
