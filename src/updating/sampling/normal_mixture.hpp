// A mixture of normal densities that is fitted to particles: where a sampler proposes to go.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::updating {

/// ln of the constant c of the multivariate t density c (1 + |x|^2 / nu)^(-(nu + d) / 2) of unit scale.
double log_t_constant(double degrees_of_freedom, double dimension);

/// g(x) = sum_k w_k N(x; m_k, C_k) + w t_3(x; m, C), the last with mean and covariance of all particles.
class NormalMixture {
 public:
  /// How many normal components there are.
  struct Size {
    Eigen::Index components = 0;  ///< 0: up to 4, by the number of particles
    bool may_grow = true;         ///< are doubled as long as Akaike's criterion is for it
  };

  /// Fits by expectation-maximisation, begun at particles drawn far from each other. Few particles take their shape
  /// from the others (their covariance is shrunk towards the mean over the components). Student's t is for what the
  /// others miss: a region of few particles, which one half of an island may hold and the other not, has a density
  /// there that is not far below the target's, so that particles leave it.
  ///
  /// @param points  [particle x dimension], at least 2 of them different in every dimension
  /// @param stream  draws the start
  NormalMixture(const Eigen::Ref<const Eigen::MatrixXd>& points, RandomStream stream, Size size);

  Eigen::Index components() const { return static_cast<Eigen::Index>(parts_.size()); }
  /// All but Student's t.
  Eigen::Index normal_components() const { return components() - 1; }
  double weight(Eigen::Index component) const { return parts_[static_cast<std::size_t>(component)].weight; }

  /// ln g(x).
  double log_density(const Eigen::Ref<const Eigen::VectorXd>& x) const;
  /// Component that x may come from: k with probability w_k N_k(x) / g(x).
  /// @param uniform  in (0, 1)
  Eigen::Index component_of(const Eigen::Ref<const Eigen::VectorXd>& x, double uniform) const;
  /// Component by its weight.
  Eigen::Index draw_component(double uniform) const;
  /// A draw of one component.
  Eigen::VectorXd draw(Eigen::Index component, RandomStream& random) const;
  /// m + sqrt(1 - step^2) (x - m) + step sqrt(s) L w, w normal: it leaves that component's density as it is. s is 1 for
  /// a normal component; t is normal given s, which is drawn from what it is given x.
  /// @param step  in (0, 1]
  Eigen::VectorXd move(Eigen::Index component, const Eigen::Ref<const Eigen::VectorXd>& x, RandomStream& random,
                       double step) const;

 private:
  struct Part {
    double weight = 0.0;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    Eigen::MatrixXd factor = {};   // L, covariance = L L'
    Eigen::MatrixXd inverse = {};  // of L
    double log_scale = 0.0;        // ln w - ln det L + ln of the density's own constant
    bool is_t = false;
  };

  void factorise(Part& part) const;
  void fit(const Eigen::MatrixXd& points, RandomStream& stream, Size size);
  void start(const Eigen::MatrixXd& points, Eigen::Index count, RandomStream& stream);
  double improve(const Eigen::MatrixXd& points);
  void widen();
  double squared_distance(const Part& part, const Eigen::Ref<const Eigen::VectorXd>& x) const;
  /// ln (w_k N_k(x)) of every component, and the largest.
  double log_parts(const Eigen::Ref<const Eigen::VectorXd>& x, std::vector<double>& values) const;

  std::vector<Part> parts_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;  // of all particles
};

}  // namespace mottle::updating
