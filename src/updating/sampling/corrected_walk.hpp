// One island on its way from a cheap likelihood to the corrected one.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "updating/sampling/corrected_posterior.hpp"
#include "updating/sampling/island.hpp"

namespace mottle::updating {

/// Asks for corrections: first of its start, then of a sweep's new blocks and of its new points, in turns, until it
/// is_done(). Between begin_walk() and judge_walk() the island walks.
class CorrectedWalk {
 public:
  /// @param island  done; it must outlive this
  CorrectedWalk(Island& island, const Correction& correction, const SamplingSettings& settings, std::uint64_t seed,
                std::uint32_t number);

  Island& island() { return island_; }
  bool is_done() const { return is_done_; }
  const Eigen::MatrixXd& points() const { return island_.points(); }
  const Eigen::MatrixXd& auxiliaries() const { return auxiliaries_; }
  /// Draws blocks again until they are possible, and weights the particles.
  void draw_possible();
  /// Corrections of the start.
  void receive_start(const Eigen::Ref<const Eigen::MatrixXd>& log_ratio);

  /// New blocks of all particles at their points; the next stage begins where the last is over.
  const Eigen::MatrixXd& propose_blocks();
  void judge_blocks(const Eigen::Ref<const Eigen::MatrixXd>& log_ratio);
  void begin_walk();
  /// Corrections at the points where the island's particles have walked to. Ends the sweep.
  void judge_walk(const Eigen::Ref<const Eigen::MatrixXd>& log_ratio);
  /// Fraction of the last walks that were accepted.
  double walk_acceptance() const { return walk_acceptance_; }

  CorrectedIsland take();

 private:
  RandomStream stream(StreamPurpose purpose, std::uint32_t particle) const;
  void weigh_start();
  void begin_stage();
  double correlation_with_start() const;

  Island& island_;
  const Correction& correction_;
  const SamplingSettings& settings_;
  std::uint64_t seed_;
  std::uint32_t number_;
  std::uint32_t stage_ = 0;
  std::uint32_t sweep_ = 0;
  int wanted_sweeps_ = 0;  // of the stage; 0: until it has decorrelated
  bool is_done_ = false;
  bool is_finished_ = true;
  double exponent_ = 0.0;
  double log_evidence_ = 0.0;
  double step_ = 1.0;         // e: a new draw of the block, as long as these are accepted
  double random_step_ = 0.0;  // c, of steps that find tails which a draw of N(0, 1) seldom meets
  double accepted_ = 0.0;
  double walk_acceptance_ = 1.0;
  std::vector<SamplingStage> stages_;
  Eigen::MatrixXd auxiliaries_;
  Eigen::VectorXd log_weight_;  // of the start; empty: all alike
  Eigen::MatrixXd log_ratio_;
  Eigen::MatrixXd proposed_;
  std::vector<bool> is_random_step_;  // kind of each particle's proposal
  Eigen::MatrixXd walked_from_;       // points
  Eigen::VectorXd walked_from_log_likelihood_;
  Eigen::MatrixXd start_points_;
  Eigen::MatrixXd start_auxiliaries_;
  Eigen::VectorXd start_log_ratio_;
};

}  // namespace mottle::updating
