// One island of a sequential Monte Carlo sampler: particles that are weighted, resampled and moved on their own.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/updating/sampling/sequential_monte_carlo.hpp"
#include "updating/sampling/normal_mixture.hpp"
#include "updating/sampling/stage_correlation.hpp"
#include "updating/sampling/trajectories.hpp"

namespace mottle::updating {

/// Asks for its likelihoods by propose() and receive(), in turns, until it is_done().
class Island {
 public:
  Island(const SamplingTarget& target, const SamplingSettings& settings, std::uint64_t seed, std::uint32_t number);

  bool is_done() const { return is_done_; }
  /// Points whose log-likelihood it wants next, all possible [point x dimension]; maybe none.
  const Eigen::MatrixXd& propose();
  /// Whether it wants their gradients as well.
  bool wants_gradient() const { return awaits_ == Awaits::gradients || awaits_ == Awaits::trajectories; }
  /// The log-likelihoods of those points, and their gradients where it wants them.
  void receive(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood,
               const Eigen::Ref<const Eigen::MatrixXd>& gradient);

  const Eigen::MatrixXd& points() const { return found_.points; }
  const SampledIsland& found() const { return found_; }

  /// Ends where it is, between two turns.
  void give_up();

  /// Goes on, when it is done, from copies of its particles: each further turn is one Metropolis step under the whole
  /// likelihood, with proposals that do not change any more. Such steps, any number of them in a row, are reversible.
  /// @param parents  whom each particle is a copy of
  void begin_walk(const std::vector<Eigen::Index>& parents);
  /// Undoes what a walk did to a particle.
  void put_back(Eigen::Index particle, const Eigen::Ref<const Eigen::VectorXd>& point, double log_likelihood);
  /// What it found; once.
  SampledIsland take() { return std::move(found_); }

 private:
  enum class Move { global, local, difference };
  enum class Awaits { start, moves, gradients, trajectories };

  RandomStream stream(StreamPurpose purpose, std::uint32_t step, std::uint32_t particle) const;
  void draw_start();
  void take_start(const Eigen::VectorXd& log_likelihood);
  void begin_stage();
  void start_from(const std::vector<Eigen::Index>& parents);
  void propose_moves();
  Eigen::Index half() const { return found_.points.rows() / 2; }
  const NormalMixture& mixture_for(Eigen::Index particle) const { return *mixtures_[particle < half() ? 1 : 0]; }
  Eigen::VectorXd propose_move(Eigen::Index particle, RandomStream& random);
  std::vector<bool> possible_proposals() const;
  std::vector<bool> open_proposals() const;
  double gain_of(Eigen::Index particle, double log_likelihood) const;
  void ask(const std::vector<bool>& is_wanted);
  void judge_moves(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood);
  void ask_gradients();
  void keep_gradients(const Eigen::Ref<const Eigen::MatrixXd>& gradient);
  void start_trajectories();
  void advance_trajectories();
  void follow_trajectories(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood,
                           const Eigen::Ref<const Eigen::MatrixXd>& gradient);
  void judge_trajectories();
  void adapt(const std::vector<double>& tried, const std::vector<double>& accepted);
  void end_move();
  /// Particles of the first half (0) or the second (1).
  auto rows_of_half(std::size_t k) const {
    return k == 0 ? Eigen::seqN(Eigen::Index{0}, half()) : Eigen::seqN(half(), found_.points.rows() - half());
  }
  ParticleStates state_of_half(std::size_t k) const;
  void take_state(std::size_t k, const ParticleStates& state);
  double correlation_with_start(std::size_t k) const;
  double correlation_by_chance() const;

  const SamplingTarget& target_;
  const SamplingSettings& settings_;
  std::uint64_t seed_;
  std::uint32_t number_;
  std::uint32_t stage_ = 0;
  std::uint32_t step_ = 0;
  bool follows_gradients_;
  Awaits awaits_ = Awaits::start;
  bool is_done_ = false;
  bool is_walking_ = false;
  double exponent_ = 0.0;
  SampledIsland found_;

  Eigen::MatrixXd start_points_;  // of the stage, after resampling
  std::array<StageStart, 2> starts_of_half_ = {};
  /// Of the first and of the second half of the particles, each for the moves of the other half: a proposal that is
  /// fitted to what it moves pulls it together.
  std::array<std::unique_ptr<const NormalMixture>, 2> mixtures_;
  Eigen::VectorXd log_mixture_;  // at the particles
  double global_share_ = 0.4;    // of the moves
  double local_step_ = 0.7;
  double difference_step_ = 0.0;
  std::array<int, 2> moves_of_half_ = {0, 0};        // in this stage; 0: the other half has not decorrelated yet
  std::array<ParticleStates, 2> ends_of_half_ = {};  // where these moves have led
  double accepted_ = 0.0;                            // fractions of the stage's moves, added up

  Eigen::MatrixXd proposals_;             // of every particle
  Eigen::VectorXd proposed_log_mixture_;  // at them
  Eigen::VectorXd thresholds_;            // ln of the uniforms that decide
  std::vector<Move> kinds_;
  std::array<double, 2> global_moves_ = {};  // of the stage: tried, accepted
  Eigen::MatrixXd gradient_;                 // of ln L at the particles; nan: not known
  Trajectories trajectories_;
  std::vector<Eigen::Index> asked_;  // particles whose proposals are possible, and may be accepted
  Eigen::MatrixXd asked_points_;
};

}  // namespace mottle::updating
