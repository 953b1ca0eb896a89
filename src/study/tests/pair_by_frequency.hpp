// Gives the modes of a table of tests without shapes the model's mode numbers, by their frequencies in ascending order.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mottle/formats/tables/csv.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "study/tests/tested_frequencies.hpp"

namespace mottle::study {

/// A tested mode and the model's mode that it is taken for; both counted from 0.
struct FrequencyPair {
  int test = 0;
  int mode = -1;            ///< -1: none is near enough
  double difference = 0.0;  ///< model / test - 1
  bool is_doubtful = false;
  int rival = -1;  ///< another mode that the test could be as well; -1: none
};

/// The assignment of the tests' modes to the model's that keeps their order and has the smallest sum of
///   ln(model / test)^2,  where a tested mode without partner counts as one that is 50 % away;
/// modes of the model may be passed over at no cost. A pair is doubtful where it is more than 15 % apart, or where the
/// sum without this pair is larger by less than that of 1 % of difference.
///
/// @param tests  ascending, greater than 0
/// @param model  ascending; those of 0 (rigid-body modes) are no partners
/// @return       one pair for each tested mode
std::vector<FrequencyPair> pair_in_order(const Eigen::VectorXd& tests, const Eigen::VectorXd& model);

/// "f12" of "f12", "f12_Hz", "f12 [Hz]": number and what follows; the same of other quantities of a mode.
struct NumberedTitle {
  std::string stem;
  int number = 0;
  std::string rest;
};

/// Nothing: the title is none of a mode, or of a component of its shape.
std::optional<NumberedTitle> numbered_title(const std::string& title);

/// The pairing of a table's columns "f1", "f2", ... (the tests' own numbers) with a model's modes.
class FrequencyPairing {
 public:
  /// Pairs the columns' means with the frequencies of the reference.
  ///
  /// @param solves       whether the reference is solved for as many modes as the tests could have; else those known
  /// are
  ///                     taken, up to the outputs' highest
  /// @throws FormatError  no column of a frequency, a value that is not greater than 0, or frequencies in another unit
  FrequencyPairing(const CsvTable& table, const StructureModel& model, bool solves);

  /// Renames the columns of the model's outputs to its numbers; those of other modes, and without partner, are taken
  /// out.
  void renumber(CsvTable& table, const StructureModel& model) const;

  const std::vector<FrequencyPair>& pairs() const { return pairs_; }

  /// Which column is which mode, which pairs are doubtful, and which modes of the tests are not used.
  std::vector<std::string> notes(const StructureModel& model) const;

  /// The pairs of columns of the outputs' numbers whose partner is another mode than that of their number, which is
  /// more than 15 % away; none where the partner of any is in doubt.
  std::vector<FrequencyPair> other_than_named(const StructureModel& model) const;

  /// A sentence on those that are more than 15 % away from the mode of their number at the prior means too, and on what
  /// takes the columns so; empty: there are none.
  ///
  /// @param at_means  frequencies of the outputs at the prior means, a row
  std::string note_on_names(const StructureModel& model, const TestedFrequencies& at_means) const;

 private:
  std::string how_to_take(const StructureModel& model) const;
  bool is_named_after_output(const FrequencyPair& pair, const StructureModel& model) const;
  int number_of(const FrequencyPair& pair) const { return numbers_[static_cast<std::size_t>(pair.test)]; }

  std::vector<int> numbers_;  // of the tests' modes as their columns name them, by ascending frequency
  std::vector<FrequencyPair> pairs_;
  Eigen::VectorXd means_;        // of the tests' modes, ascending
  Eigen::VectorXd frequencies_;  // of the reference [mode]
};

}  // namespace mottle::study
