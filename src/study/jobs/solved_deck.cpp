#include "study/jobs/solved_deck.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/model/units.hpp"
#include "study/jobs/init_model.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/proposed_units.hpp"

namespace mottle::study {
namespace {

constexpr int k_usual_modes = 10;
constexpr int k_max_modes = 500;  // of a range whose number of modes the deck does not say

/// Hz; zero where the eigenvalue of a mass-normalised shape is within rounding of the stiffness, as a rigid motion's
/// is, or of the solver's shift s:
///   |lambda| <= max(10 eps |phi|' |K| |phi|, eps |s|)
Eigen::VectorXd frequencies_beyond_rounding(const SparseModes& modes, const SparseMatrix& stiffness) {
  constexpr double k_epsilon = std::numeric_limits<double>::epsilon();
  const Eigen::MatrixXd sizes = modes.vectors.cwiseAbs();
  const Eigen::VectorXd terms =
      sizes.cwiseProduct(symmetric_product(stiffness.cwiseAbs(), sizes)).colwise().sum().transpose();
  const Eigen::VectorXd frequencies = natural_frequencies_hz(modes.values);
  const Eigen::ArrayXd rounding = (10.0 * k_epsilon * terms.array()).max(k_epsilon * std::abs(modes.shift));
  return (modes.values.array().abs() <= rounding).select(0.0, frequencies);
}

/// How many of the lowest modes EIGRL (V1, V2, ND) asks for: all up to V2, or ND from V1 on, whichever are fewer. Modes
/// below V1 are solved too, so that mode numbers count from the lowest.
int modes_of_method(const FiniteElementStructure& structure, const AnalysisSettings& asked,
                    std::vector<std::string>& notes) {
  const auto count_below = [&](double hertz) {
    const SparseStructure::Matrices matrices = structure.matrices_at(Eigen::VectorXd());
    return count_eigenvalues_below(matrices.stiffness, matrices.mass, std::pow(2.0 * std::numbers::pi * hertz, 2));
  };
  const int below = asked.lowest_frequency > 0.0 ? count_below(asked.lowest_frequency) : 0;
  if (below > 0) {
    notes.push_back(
        fmt::format("{} modes lie below {:g} Hz, where the deck's method begins; they are listed too, mode "
                    "numbers count from the lowest",
                    below, asked.lowest_frequency));
  }
  const int counted = std::max(0, below) + (asked.modes > 0 ? asked.modes : k_usual_modes);
  if (asked.highest_frequency <= 0.0) return counted;
  const int in_range = std::max(1, count_below(asked.highest_frequency));
  if (asked.modes > 0) return std::min(counted, in_range);
  if (in_range > k_max_modes) {
    notes.push_back(
        fmt::format("{} modes lie below {:g} Hz, where the deck's method ends; the lowest {} are solved, "
                    "--modes asks for more",
                    in_range, asked.highest_frequency, k_max_modes));
  }
  return std::min(in_range, k_max_modes);
}

/// Notes modes that exist (the inertia of K - s M for a very high s) beyond those that were found.
void note_lost_modes(const SparseStructure::Matrices& matrices, SolvedDeck& solved) {
  constexpr double k_above_all = 100.0;
  const Eigen::ArrayXd k = matrices.stiffness.diagonal();
  const Eigen::ArrayXd m = matrices.mass.diagonal();
  const double highest = (m > 0.0).select(k / m, 0.0).maxCoeff();
  const int there = count_eigenvalues_below(matrices.stiffness, matrices.mass, k_above_all * highest);
  const Eigen::VectorXd& frequencies = solved.frequencies;
  const auto lost = there - static_cast<int>(frequencies.size());
  if (lost <= 0) return;
  solved.notes.push_back(
      fmt::format("{} mode{} above {:.5g} {} {} not listed: so far above the others that rounding hides {}", lost,
                  lost == 1 ? "" : "s", frequencies.size() > 0 ? frequencies(frequencies.size() - 1) : 0.0,
                  solved.frequency_unit, lost == 1 ? "is" : "are", lost == 1 ? "it" : "them"));
}

constexpr double k_inaccurate = 1e-4;  // relative residual of a mode

double worst_residual(const SparseModes& modes) {
  return modes.residuals.size() > 0 ? modes.residuals.maxCoeff() : 0.0;
}

/// Masses that differ by many orders of magnitude can leave no digit of the lowest modes.
void require_accuracy(const std::filesystem::path& deck, const SparseModes& modes) {
  if (modes.residuals.size() == 0) return;
  Eigen::Index worst = 0;
  const double residual = modes.residuals.maxCoeff(&worst);
  require(
      residual <= k_inaccurate,
      "{}: mode {} is not accurate, its residual is {:.1e}: some masses are smaller than others by so many orders of "
      "magnitude that rounding hides the lowest modes. Leave these points without mass, or give them their true one",
      deck.string(), worst + 1, residual);
}

void refuse_other_models(const std::filesystem::path& deck) {
  require(deck.extension() != ".msh",
          "{}: a mesh alone has no materials and supports; write a study of kind \"mesh\" (docs/howto/mesh.md), whose "
          "modes mottle check gives",
          deck.string());
  const std::string kind = model_kind_of(deck);
  require(kind != "calculix",
          "{}: is a CalculiX deck, and this command reads those of Nastran; `mottle targets` lists its modes and "
          "numbers, `mottle init` makes a study of it",
          deck.string());
  require(kind != "command",
          "{}: has placeholders {{{{name}}}} and is no Nastran deck by its name; `mottle init` makes a study of it",
          deck.string());
}

}  // namespace

SolvedDeck solve_deck(const std::filesystem::path& deck, const NastranOptions& options, int modes,
                      const std::atomic<bool>* stop, int beyond) {
  const double start = steady_seconds();
  refuse_other_models(deck);
  NastranModel read = read_nastran_model(deck, options);
  SolvedDeck solved;
  solved.read_seconds = steady_seconds() - start;
  solved.notes = std::move(read.notes);
  const AnalysisSettings asked = read.model.settings;
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
  if (modes == 0) modes = modes_of_method(*solved.structure, asked, solved.notes);
  solved.assembly_seconds = assembled - start - solved.read_seconds;
  solved.modes = solved.solver->solve_one(none, {.modes = modes + beyond, .counts_below = true, .stop = stop});
  const bool is_sound =
      solved.modes.failure.empty() && solved.modes.is_complete() && worst_residual(solved.modes) <= k_inaccurate;
  if (beyond > 0 && !is_sound) {  // it may be a matter of modes that nobody asked for
    solved.modes = solved.solver->solve_one(none, {.modes = modes, .counts_below = true, .stop = stop});
  }
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
  require_accuracy(deck, solved.modes);
  solved.solution_seconds = steady_seconds() - assembled;
  const SparseStructure::Matrices matrices = solved.structure->matrices_at(none);
  solved.frequencies = frequencies_beyond_rounding(solved.modes, matrices.stiffness);
  solved.asked = std::min<Eigen::Index>(modes, solved.frequencies.size());
  solved.frequency_unit = unit_names(propose_units(solved.structure->model()).units).frequency;
  if (solved.frequencies.size() < modes) note_lost_modes(matrices, solved);
  return solved;
}

}  // namespace mottle::study
