// Which modes of a model a set of tests found, as a first study pairs them.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {

struct PairedTests {
  std::string pairing = {};  ///< "mac" or "frequency"
  int specimens = 0;
  std::vector<InitMode> modes = {};  ///< elastic modes, ascending; also those that were not tested
  std::vector<std::string> notes = {};
};

/// Those whose frequency is not 0, without tests.
///
/// @param frequencies  of all modes of the deck, those of rigid-body modes 0 [mode]
std::vector<InitMode> elastic_modes(const Eigen::VectorXd& frequencies);

/// Pairs the tests with all elastic modes of the model, by MAC where they come with shapes, else by frequency.
///
/// @param draft        a study whose outputs are the frequencies of the elastic modes
/// @param frequencies  of all modes of the deck, those of rigid-body modes 0 [mode]
/// @throws InvalidInput, FormatError  tests that cannot be paired
PairedTests pair_for_proposal(const Study& draft, TestContents contents, const Eigen::VectorXd& frequencies);

}  // namespace mottle::study
