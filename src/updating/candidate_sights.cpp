// What the tests can see of parameters and candidates: sizes and angles of their sensitivities.
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "candidate_fits.hpp"

namespace mottle {
namespace {

/// dy/dx of every parameter and candidate at x [output x parameter]; 0 where the model fails on both sides.
Eigen::MatrixXd sensitivity_at(CandidateFits& fits, const Eigen::VectorXd& x) {
  constexpr double k_step = 0.05;  // of a prior deviation
  const ParameterSpace& space = fits.problem().space;
  const Eigen::VectorXd step = k_step * space.prior().covariance().diagonal().cwiseSqrt();
  const Eigen::Index q = x.size();
  Eigen::MatrixXd samples = x.transpose().replicate(2 * q + 1, 1);
  std::vector<Eigen::Index> possible;
  for (Eigen::Index i = 0; i < q; ++i) {
    samples(2 * i, i) += step(i);
    samples(2 * i + 1, i) -= step(i);
  }
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    if (space.is_possible(samples.row(s))) possible.push_back(s);
  }
  const auto p = static_cast<Eigen::Index>(fits.problem().model.outputs().size());
  Eigen::MatrixXd y = Eigen::MatrixXd::Constant(samples.rows(), p, std::nan(""));
  y(possible, Eigen::all) = fits.outputs_at(samples(possible, Eigen::all));
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(p, q);
  for (Eigen::Index i = 0; i < q; ++i) {
    const bool has_ahead = y.row(2 * i).allFinite();
    const bool has_behind = y.row(2 * i + 1).allFinite();
    if (!has_ahead && !has_behind) continue;
    const Eigen::RowVectorXd from = has_behind ? y.row(2 * i + 1) : y.row(2 * q);
    const Eigen::RowVectorXd to = has_ahead ? y.row(2 * i) : y.row(2 * q);
    slope.col(i) = (to - from).transpose() / (step(i) * (has_ahead && has_behind ? 2.0 : 1.0));
  }
  return slope;
}

/// C^-1/2; directions without variance to rounding count with the smallest that there is.
Eigen::MatrixXd whitener(const Eigen::MatrixXd& covariance) {
  constexpr double k_least = 1e-10;
  const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd correlation =
      deviation.cwiseInverse().asDiagonal() * covariance * deviation.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
  const Eigen::VectorXd root = solver.eigenvalues().cwiseMax(k_least).cwiseSqrt().cwiseInverse();
  return root.asDiagonal() * solver.eigenvectors().transpose() * deviation.cwiseInverse().asDiagonal();
}

/// What a direction keeps when the span of `others` is taken from it.
Eigen::VectorXd own_part(const Eigen::MatrixXd& others, const Eigen::VectorXd& direction) {
  if (others.cols() == 0) return direction;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
  factor.setThreshold(1e-8);
  factor.compute(others * others.colwise().norm().cwiseMax(1e-300).cwiseInverse().asDiagonal());
  const Eigen::MatrixXd q = factor.householderQ() * Eigen::MatrixXd::Identity(others.rows(), factor.rank());
  return direction - q * (q.transpose() * direction);
}

}  // namespace

Sights look_at(CandidateFits& fits, const SetFit& base) {
  const ParameterSpace& space = fits.problem().space;
  const Eigen::Index given = fits.settings().given;
  const Eigen::Index all = space.count();
  Eigen::VectorXd x = space.prior().mean();
  x.head(given) = base.mean;
  const Eigen::MatrixXd slope = sensitivity_at(fits, x);
  const Eigen::MatrixXd reached = slope.leftCols(given);
  Eigen::MatrixXd total = reached * base.covariance * reached.transpose();
  total.diagonal() += base.fit.noise;
  const Eigen::VectorXd scale = space.prior().covariance().diagonal().cwiseSqrt();
  const double root_n = std::sqrt(static_cast<double>(fits.specimens()));
  const Eigen::MatrixXd white = root_n * whitener(total) * slope * scale.asDiagonal();
  const Eigen::VectorXi active = space.active_bounds(x);
  Sights sights;
  Eigen::MatrixXd parts(white.rows(), all - given);
  for (Eigen::Index i = 0; i < all; ++i) {
    std::vector<Eigen::Index> others;  // that are free to imitate it
    for (Eigen::Index j = 0; j < given; ++j) {
      if (j != i && active(j) == 0) others.push_back(j);
    }
    const Eigen::VectorXd own = own_part(white(Eigen::all, others), white.col(i));
    Sight sight{space.parameters()[static_cast<std::size_t>(i)].name, space.prior().mean()(i), scale(i)};
    sight.visibility = white.col(i).norm();
    sight.own_share = sight.visibility > 0.0 ? std::min(own.norm() / sight.visibility, 1.0) : 0.0;
    if (sight.own_share < 1e-6) sight.own_share = 0.0;
    sight.inflation = 1.0 / (sight.own_share * sight.own_share);
    sights.all.push_back(std::move(sight));
    if (i < given) continue;
    const double length = own.norm();
    const bool is_seen = sights.all.back().own_share > 0.0;
    parts.col(i - given) = is_seen ? Eigen::VectorXd(own / length) : Eigen::VectorXd(Eigen::VectorXd::Zero(own.size()));
  }
  sights.cosines = parts.transpose() * parts;
  std::vector<Eigen::Index> free;
  for (Eigen::Index j = 0; j < given; ++j) {
    if (active(j) == 0) free.push_back(j);
  }
  Eigen::Index rank = 0;
  if (!free.empty()) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
    factor.setThreshold(1e-8);
    factor.compute(white(Eigen::all, free));
    rank = factor.rank();
  }
  sights.judging = white.rows() - rank;
  return sights;
}

}  // namespace mottle
