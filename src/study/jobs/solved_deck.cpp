#include "study/jobs/solved_deck.hpp"

#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "study/jobs/job_files.hpp"

namespace mottle::study {
namespace {

constexpr int k_usual_modes = 10;

/// Hz; zero where the eigenvalue of a mass-normalised shape is within rounding of the stiffness, as a rigid motion's
/// is:
///   |lambda| <= 10 eps |phi|' |K| |phi|
Eigen::VectorXd frequencies_beyond_rounding(const SparseModes& modes, const SparseMatrix& stiffness) {
  constexpr double k_rounding = 10.0 * std::numeric_limits<double>::epsilon();
  const Eigen::MatrixXd sizes = modes.vectors.cwiseAbs();
  const Eigen::VectorXd terms =
      sizes.cwiseProduct(symmetric_product(stiffness.cwiseAbs(), sizes)).colwise().sum().transpose();
  const Eigen::VectorXd frequencies = natural_frequencies_hz(modes.values);
  return (modes.values.array().abs() <= k_rounding * terms.array()).select(0.0, frequencies);
}

}  // namespace

SolvedDeck solve_deck(const std::filesystem::path& deck, const std::set<std::string>& ignore_cards, int modes) {
  const double start = steady_seconds();
  NastranModel read = read_nastran_model(deck, {.ignore_cards = ignore_cards});
  SolvedDeck solved;
  solved.read_seconds = steady_seconds() - start;
  solved.notes = std::move(read.notes);
  if (modes == 0) modes = read.model.settings.modes > 0 ? read.model.settings.modes : k_usual_modes;
  const Eigen::VectorXd none;
  try {
    auto structure =
        std::make_unique<FiniteElementStructure>(std::move(read.model), std::vector<ParameterTargets>{}, none);
    solved.structure = structure.get();
    solved.solver = std::make_unique<ExactSolver>(std::move(structure));
  } catch (const FormatError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", deck.string(), error.what()));
  }
  const double assembled = steady_seconds();
  solved.assembly_seconds = assembled - start - solved.read_seconds;
  solved.modes = solved.solver->solve_one(none, {.modes = modes, .counts_below = true});
  if (!solved.modes.failure.empty()) {
    throw InvalidInput(fmt::format("{}: {}", deck.string(), solved.solver->failure_text(solved.modes)));
  }
  if (!solved.modes.is_complete()) {
    if (solved.modes.values.size() < modes) {
      throw InvalidInput(
          fmt::format("{}: {} modes are asked for, of which the highest that {} equations have cannot be told "
                      "from rounding; ask for fewer with --modes",
                      deck.string(), modes, solved.structure->mode_count()));
    }
    throw SystemFailure(fmt::format("{}: {} modes were found below {:.6g} (rad/s)^2, the inertia of K - s M counts {}",
                                    deck.string(), solved.modes.values.size(), solved.modes.counted_at,
                                    solved.modes.counted_below));
  }
  solved.solution_seconds = steady_seconds() - assembled;
  solved.frequencies = frequencies_beyond_rounding(solved.modes, solved.structure->matrices_at(none).stiffness);
  return solved;
}

}  // namespace mottle::study
