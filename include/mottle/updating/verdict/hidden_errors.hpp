// The power of the verdict's test of the means against errors in quantities that no parameter moves: how large such an
// error must be to be refused, and how far a smaller one leads the estimates astray.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// Tests about the updated mean, to first order: z_s = f(x) + G dx + H e + S_s, S_s ~ N(0, C) by specimen, and a model
/// error d ~ N(0, D) that all of them share.
struct LinearTests {
  Eigen::MatrixXd sensitivity;      ///< G = dy/dx [output x parameter]
  Eigen::MatrixXd errors;           ///< H: change of the outputs by a relative error of 1 [output x quantity]
  Eigen::MatrixXd covariance;       ///< C = G Sigma G' + R, positive definite [output x output]
  Eigen::MatrixXd values;           ///< the tests; only which are nan counts [specimen x output]
  Eigen::VectorXd model_error_std;  ///< square roots of D's diagonal [output]; empty: none
  /// Variances of the noise where the test of the means is that of residuals within specimens, `mean-residuals`; empty:
  /// it is that of the means themselves, by C [output]
  Eigen::VectorXd noise = {};
  /// Where the test of the means knows the covariance of a test and of the cloud's mean otherwise than by C, as
  /// `mean-agreement` does from a cloud with the outputs' curvature; empty: by C [output x output]
  Eigen::MatrixXd of_test = {};
  Eigen::MatrixXd of_cloud = {};
};

/// What the means of the tests show of each error, and what it does to the estimates.
struct ErrorEffects {
  /// Noncentrality of the test of the means by a relative error of 1: with the information J of (parameters, error) in
  /// what that test looks at (all tests, or within specimens, or the means), J_ee - J_ex J_xx^+ J_xe, the part of the
  /// error's effect that no parameters imitate; 0 where nothing remains [quantity]
  Eigen::VectorXd noncentrality;
  Eigen::MatrixXd shift;                      ///< J_xx^+ J_xe: of the estimated means [parameter x quantity]
  Eigen::MatrixXd mean_covariance;            ///< J_xx^+: of the estimated means [parameter x parameter]
  Eigen::Index means_degrees_of_freedom = 0;  ///< degrees of freedom that the fit leaves to the means
  Eigen::Index denominator_degrees_of_freedom =
      0;  ///< and to the scatter about them, where the noise's level is estimated
};

/// Effects of small errors on tests and estimates. Missing entries drop out of their specimens.
///
/// @throws InvalidInput  C is not positive definite
ErrorEffects error_effects(const LinearTests& tests);

/// The verdict's test of the means, with a power of 80 %, and what it protects.
struct MeansTest {
  double level = 0.05;
  double denominator = 0.0;          ///< degrees of freedom of its variance; infinite: known; 0: it was not made
  double stated_change = 0.1;        ///< relative error for which the harm is stated where the test sees none
  Eigen::VectorXd half_widths = {};  ///< of the 95 % intervals of the means, 0 where there is none [parameter]
  Eigen::VectorXd prior_std = {};    ///< [parameter]; empty: not known
  Eigen::VectorXd room_below = {};   ///< how far each mean may still move down and up [parameter]
  Eigen::VectorXd room_above = {};
};

/// An error of a quantity that no parameter moves.
struct HiddenError {
  Eigen::Index quantity = 0;
  /// The relative error that the test refuses with that power. Where that is more than 1, or nothing would remain of
  /// it, it is not detected, and this is `stated_change`, or less where a mean would leave its room before.
  double relative_change = 0.0;
  bool is_detected = false;
  bool is_cut = false;  ///< not detected, and less than `stated_change`: a larger one would take a mean out of its room
  Eigen::VectorXd would_move =
      {};  ///< shift of the estimated means in half-widths, of an error upwards; nan: no interval [parameter]
  Eigen::VectorXd prior_deviations = {};  ///< the same shift in prior deviations; nan: not known [parameter]

  /// The shift of a parameter in half-widths of its interval, in prior deviations where it has none; 0 where unknown.
  double harm_to(Eigen::Index parameter) const;

  /// The largest of them.
  double harm() const;

  /// Whether a mean moves by more than its prior deviation: no model counts as linear so far.
  bool is_beyond_first_order() const;
};

/// One for each quantity, in their order.
std::vector<HiddenError> hidden_errors(const ErrorEffects& effects, const MeansTest& test);

}  // namespace mottle::updating
