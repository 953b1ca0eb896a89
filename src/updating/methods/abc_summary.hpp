// How `abc` simulates sets of tests, and what it compares of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "mottle/layers.hpp"
#include "updating/methods/abc_search.hpp"

namespace mottle::updating {

/// Sets of tests as a population gives them: specimens drawn from the points of an evaluated cloud that is carried
/// there, noise, the missing entries of the real tests, and what one model error for all leaves in those.
class TestSimulator {
 public:
  TestSimulator(const UpdatingProblem& problem, const PopulationCoordinates& coordinates,
                const NearestPopulation& nearest)
      : problem_(problem), coordinates_(coordinates), transport_(*nearest.transport), offset_(nearest.offset) {}

  /// @param key, set  name the random stream
  Eigen::MatrixXd simulate(const Eigen::Ref<const Eigen::VectorXd>& coordinates, const StreamKey& key,
                           std::uint32_t set) const;

 private:
  const UpdatingProblem& problem_;
  const PopulationCoordinates& coordinates_;
  const CloudTransport& transport_;
  const SharedOffset& offset_;
};

/// What is known before sampling, by normal theory: where proposals begin, and which share of a parameter's scatter
/// noise may pretend.
struct RoughKnowledge {
  Eigen::VectorXd centre;       ///< [coordinate]
  Eigen::VectorXd std;          ///< [coordinate]
  Eigen::VectorXd noise_share;  ///< standard deviation of noise in a specimen's own parameters [parameter]
};

/// Everything that the stages share; `log_prior`: up to a constant, -infinity where a population is not allowed.
struct AbcSampler {
  const UpdatingProblem& problem;
  const PopulationCoordinates& coordinates;
  const NearestPopulation& nearest;
  const RoughKnowledge& known;
  const RunContext& context;
  Eigen::MatrixXd tests;  ///< as distances see them [specimen x output]
  TestSimulator simulator;
  MovingCloud cloud;

  double log_prior(const Eigen::Ref<const Eigen::VectorXd>& at) const;
};

/// Summaries of sets of tests: the gradient of their distance from one reference cloud, in units of its own scatter.
class AbcSummary {
 public:
  /// @param reference  coordinates of the cloud's population
  /// @param stage      names the random streams of its pilot sets
  AbcSummary(const AbcSampler& sampler, const Eigen::VectorXd& reference, std::uint32_t stage);

  Eigen::VectorXd of(const Eigen::MatrixXd& tests) const { return scale_.transpose() * gradient_.of_tests(tests); }

  /// Of a set simulated at each point; throws Stopped on request [set x coordinate].
  void fill(Eigen::MatrixXd& summaries, const Eigen::MatrixXd& points, const StreamKey& key) const;

  /// Coordinates that sets with these summaries speak for: one step of the search from the reference cloud
  /// [set x coordinate].
  Eigen::MatrixXd estimates(const Eigen::MatrixXd& summaries) const {
    return ((summaries.rowwise() - expected_) * slopes_).rowwise() + reference_.transpose();
  }

  /// Coordinates of the population whose cloud is nearest to these tests: Newton's steps from the reference with the
  /// slopes there.
  Eigen::VectorXd nearest(const Eigen::MatrixXd& tests) const;

 private:
  Eigen::MatrixXd pilot_at(const Eigen::VectorXd& point, std::uint32_t stage) const;
  void find_slopes(std::uint32_t stage);

  const AbcSampler& sampler_;
  DistanceGradient gradient_;
  Eigen::VectorXd reference_;
  Eigen::MatrixXd scale_;
  Eigen::RowVectorXd expected_;  // mean summary at the reference
  Eigen::MatrixXd slopes_;       // of coordinates on summaries [summary x coordinate]
};

}  // namespace mottle::updating
