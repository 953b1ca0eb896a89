// Steps that iterative methods share: evaluate the cloud of a state, judge convergence.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Mean and covariance of the tests, missing entries left out.
struct TestMoments {
  Eigen::VectorXd mean;        ///< [output]
  Eigen::MatrixXd covariance;  ///< unbiased; zero of an output that is measured once [output x output]
  Eigen::VectorXi count;       ///< measured values of each output
};

/// Throws InvalidInput: an output without any measured value.
TestMoments test_moments(const TestData& tests);

/// Throws InvalidInput: an output that only one of several specimens has, for methods that need its scatter.
void require_repeated_outputs(const TestData& tests, const std::vector<Quantity>& outputs);

/// Evaluates the cloud of a state and compares it with the tests; announces it as a phase.
///
/// @param distribution  the state's distribution; the prior for the first
/// @param index         of the state: 0 is that before the update, others are iterations
IterationRecord record_state(const UpdatingProblem& problem, const TestMoments& tests,
                             const JointDistribution& distribution, int index, const RunContext& context);

/// The same of an estimate: the last state.
IterationRecord record_state(const UpdatingProblem& problem, const TestMoments& tests, const Estimate& estimate,
                             const RunContext& context);

/// Announces an iteration, numbered from 1 on, of at most `problem.iterations`.
void begin_iteration(const UpdatingProblem& problem, std::int64_t index, const RunContext& context);

/// Fills the distances between the outputs' means of a state and of the tests; the Mahalanobis distance is nan where
/// the tests do not scatter.
void set_distances(IterationRecord& record, const TestMoments& tests);

/// Puts a state at the end of the history and counts its runs. Clouds between the first and the last are thinned to
/// what a plot can show.
void append_state(UpdatingResult& result, IterationRecord state);

/// The largest movement from one state to the next of any mean or standard deviation, in units of the prior's
/// standard deviation of that parameter.
double largest_movement(const Eigen::Ref<const Eigen::VectorXd>& prior_std, const Eigen::VectorXd& mean_before,
                        const Eigen::MatrixXd& covariance_before, const Eigen::VectorXd& mean_after,
                        const Eigen::MatrixXd& covariance_after);

/// Whether the movements go round in circles: none of the last `window` is smaller than one before them.
bool is_stalled(const std::vector<double>& movements, std::size_t window);

/// What an iteration brings to rest, for the message of how it ended.
struct EndingWords {
  std::string at_rest = "no parameter moves";  ///< "... by more than 0.001 of its prior standard deviation"
  std::string moving = "the parameters";       ///< "... did not converge"
  std::string stalled = "no step brings the outputs nearer to the tests";  ///< the whole sentence
};

/// How an iteration ended, in words.
/// @param updates  iterations that were made
std::string ending_message(UpdatingStatus status, std::size_t updates, double tolerance, const EndingWords& words = {});

}  // namespace mottle::updating
