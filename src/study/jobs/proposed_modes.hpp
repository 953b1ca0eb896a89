// Which modes of a model a set of tests found, as a first study pairs them.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "mottle/study/run_settings.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {

struct PairedTests {
  std::string pairing = {};  ///< "mac", "frequency", or "named" of a table that counts modes as the model
  int specimens = 0;
  std::vector<InitMode> modes = {};  ///< elastic modes, ascending; also those that were not tested
  InitShapes shapes = {};            ///< of a table that counts modes as the model
  std::vector<std::string> notes = {};
};

/// Those whose frequency is not 0, without tests.
///
/// @param frequencies  of all modes of the deck, those of rigid-body modes 0 [mode]
std::vector<InitMode> elastic_modes(const Eigen::VectorXd& frequencies);

/// Pairs the tests with all elastic modes of the model, by MAC where they come with shapes, else by frequency. A table
/// with shapes is taken by the numbers of its columns where these agree with the shapes; else by frequency, and a note
/// says what the shapes show.
///
/// @param draft        a study whose outputs are the frequencies of the elastic modes
/// @param frequencies  of all modes of the deck, those of rigid-body modes 0 [mode]
/// @param settings     of a model whose matrices are made by runs: where they are kept
/// @throws InvalidInput, FormatError  tests that cannot be paired
PairedTests pair_for_proposal(const Study& draft, TestContents contents, const Eigen::VectorXd& frequencies,
                              const RunSettings& settings);

}  // namespace mottle::study
