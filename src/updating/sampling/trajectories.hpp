// Hamiltonian trajectories of the particles of one island: leapfrog steps along gradients, all particles at once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

namespace mottle::updating {

/// Log-likelihood and its gradient at particles; a row of `gradient` that is not known is nan.
struct ParticleStates {
  Eigen::MatrixXd points;          ///< u [particle x dimension]
  Eigen::VectorXd log_likelihood;  ///< [particle]
  Eigen::MatrixXd gradient;        ///< of ln L [particle x dimension]
};

/// Moves u under the energy H = |u|^2 / 2 - b ln L(u) + |w|^2 / 2, w the momentum in coordinates v, u = L v, in which
/// the posterior is about as wide in each direction:
///
///   w += h/2 L' (b grad ln L - u);   u += h L w;   w += h/2 L' (b grad ln L - u)
///
/// repeated for a time that is drawn between pi / 4 and 3 pi / 4, a quarter to three quarters of half an oscillation of
/// a normal posterior. The end is accepted with probability exp(H_start - H_end), which leaves the posterior as it is
/// whatever function of u takes the place of the gradient. A trajectory that meets a point that is not possible, a run
/// that fails, or an energy that has risen by more than 1,000 (it diverges) goes nowhere.
/// Source: [Neal2011].
class Trajectories {
 public:
  /// Takes L L' for one half of the particles from the covariance of the other.
  void fit(const Eigen::MatrixXd& points);
  /// Starts one of every particle. `streams` draw momentum and time.
  void start(const ParticleStates& from, double exponent, std::vector<RandomStream>& streams);
  bool are_done() const { return moving_ == 0; }
  /// The next points of those that are on their way [particle x dimension]; the rows of others are where they stay.
  const Eigen::MatrixXd& advance();
  const std::vector<bool>& are_moving() const { return is_moving_; }
  /// Ends a trajectory that has met a point which is not possible.
  void stop(Eigen::Index particle);
  /// ln L and its gradient at a particle's point; to be called for each that is moving.
  void receive(Eigen::Index particle, double log_likelihood, const Eigen::Ref<const Eigen::RowVectorXd>& gradient);
  /// The second half of the step, when all have received.
  void finish_step();
  /// H_start - H_end [particle]; -infinity of those that were stopped or diverged.
  const Eigen::VectorXd& gains() const { return gains_; }
  const ParticleStates& ends() const { return now_; }
  int divergences() const { return divergences_; }
  /// Adapts the step to the mean probability of acceptance.
  void adapt();

 private:
  Eigen::Index half() const { return now_.points.rows() / 2; }
  void kick();
  double energy(Eigen::Index particle) const;

  std::array<Eigen::MatrixXd, 2> factors_;  // L, for the first and the second half of the particles
  double step_ = 0.0;
  double exponent_ = 0.0;
  ParticleStates now_;
  Eigen::MatrixXd momenta_;  // w [particle x dimension]
  Eigen::VectorXd steps_;    // h of each, 0: not moving
  std::vector<int> left_;    // steps
  std::vector<bool> is_moving_;
  Eigen::Index moving_ = 0;
  Eigen::VectorXd start_energy_;
  Eigen::VectorXd gains_;
  int divergences_ = 0;
};

}  // namespace mottle::updating
