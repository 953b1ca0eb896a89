// What the tests can see of parameters and candidates: sizes and angles of their sensitivities.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/covariance_axes.hpp"
#include "updating/diagnosis/candidate_fits.hpp"

namespace mottle::updating {
namespace {

constexpr double k_min_variance = 1e-10;  // of a direction of the outputs without variance to rounding

/// What a direction keeps when the span of `others` is taken from it.
Eigen::VectorXd own_part(const Eigen::MatrixXd& others, const Eigen::VectorXd& direction) {
  if (others.cols() == 0) return direction;
  const Eigen::VectorXd scale = others.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd q = PivotedQr(others * scale.asDiagonal(), 1e-8).range();
  return direction - q * (q.transpose() * direction);
}

}  // namespace

DetectabilityAnalysis analyse_detectability(const CandidateFits& fits, const SetFit& base, Eigen::MatrixXd slope) {
  const ParameterSpace& space = fits.problem().space;
  const Eigen::Index given = fits.settings().given;
  const Eigen::Index all = space.count();
  Eigen::VectorXd x = space.prior().mean();
  x.head(given) = base.mean;
  for (auto column : slope.colwise()) {
    if (!column.allFinite()) column.setZero();
  }
  const Eigen::MatrixXd reached = slope.leftCols(given);
  Eigen::MatrixXd total = reached * base.covariance * reached.transpose();
  total.diagonal() += base.fit.noise;
  const Eigen::VectorXd scale = space.prior().covariance().diagonal().cwiseSqrt();
  const double root_n = std::sqrt(static_cast<double>(fits.specimens()));
  const Eigen::MatrixXd white = root_n * CovarianceAxes(total).whitening(k_min_variance) * slope * scale.asDiagonal();
  Eigen::VectorXd location = x;
  location.head(given) = base.location;
  const Eigen::VectorXi active = space.active_bounds(location);
  DetectabilityAnalysis analysis;
  Eigen::MatrixXd parts(white.rows(), all - given);
  for (Eigen::Index i = 0; i < all; ++i) {
    std::vector<Eigen::Index> others;  // that are free to imitate it
    for (Eigen::Index j = 0; j < given; ++j) {
      if (j != i && active(j) == 0) others.push_back(j);
    }
    const Eigen::VectorXd own = own_part(white(Eigen::all, others), white.col(i));
    Detectability detectability{space.parameters()[static_cast<std::size_t>(i)].name, space.prior().mean()(i),
                                scale(i)};
    detectability.visibility = white.col(i).norm();
    detectability.own_share =
        detectability.visibility > 0.0 ? std::min(own.norm() / detectability.visibility, 1.0) : 0.0;
    if (detectability.own_share < 1e-6) detectability.own_share = 0.0;
    detectability.inflation = 1.0 / (detectability.own_share * detectability.own_share);
    analysis.all.push_back(std::move(detectability));
    if (i < given) continue;
    const double length = own.norm();
    const bool is_seen = analysis.all.back().own_share > 0.0;
    parts.col(i - given) = is_seen ? Eigen::VectorXd(own / length) : Eigen::VectorXd(Eigen::VectorXd::Zero(own.size()));
  }
  analysis.cosines = parts.transpose() * parts;
  std::vector<Eigen::Index> free;
  for (Eigen::Index j = 0; j < given; ++j) {
    if (active(j) == 0) free.push_back(j);
  }
  const Eigen::Index rank = free.empty() ? 0 : PivotedQr(white(Eigen::all, free), 1e-8).rank();
  analysis.judging = white.rows() - rank;
  return analysis;
}

}  // namespace mottle::updating
