#include "study/proposal/linear_explanation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::study {
namespace {

constexpr double k_noise_log_std = 0.7;  // of the prior of a noise level: a factor of 2

/// gamma that are tried: standard deviations of the scatter from 1/200 of the prior's to twice it, and none.
std::vector<double> tried_variances() {
  std::vector<double> tried{0.0};
  for (double deviation = 0.005; deviation < 2.1; deviation *= std::sqrt(2.0)) tried.push_back(deviation * deviation);
  return tried;
}

struct MissingFill {
  Eigen::VectorXd values;
  Eigen::MatrixXd variance;  // of what was filled in, 0 elsewhere
};

/// Conditional moments of the missing values given the others, under N(mean, covariance).
MissingFill fill_missing(const Eigen::VectorXd& values, const Eigen::VectorXd& mean,
                         const Eigen::MatrixXd& covariance) {
  std::vector<Eigen::Index> known, missing;
  for (Eigen::Index k = 0; k < values.size(); ++k) (std::isnan(values(k)) ? missing : known).push_back(k);
  MissingFill filled{values, Eigen::MatrixXd::Zero(values.size(), values.size())};
  if (missing.empty()) return filled;
  const linalg::CholeskyFactor factor(covariance(known, known));
  const Eigen::MatrixXd gain = factor.solve(Eigen::MatrixXd(covariance(known, missing))).transpose();
  filled.values(missing) = mean(missing) + gain * (values(known) - mean(known));
  filled.variance(missing, missing) = covariance(missing, missing) - gain * covariance(known, missing);
  return filled;
}

}  // namespace

Eigen::VectorXd known_means(const Eigen::MatrixXd& values) {
  Eigen::VectorXd means(values.cols());
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    const auto known = values.col(k).array().isFinite();
    means(k) = known.select(values.col(k).array(), 0.0).sum() / static_cast<double>(known.count());
  }
  return means;
}

LinearExplanation::LinearExplanation(const LinearisedTests& problem)
    : problem_(&problem),
      values_(problem.differences),
      mean_(known_means(problem.differences)),
      specimens_(static_cast<double>(problem.differences.rows())),
      noise_(problem.typical_noise) {
  scatter_ = Eigen::MatrixXd::Identity(mean_.size(), mean_.size());
  update_factors();
  update_moments();
  estimate(2);
}

bool LinearExplanation::has(Eigen::Index number) const {
  return std::ranges::find(chosen_, number) != chosen_.end();
}

void LinearExplanation::update_factors() {
  const Eigen::VectorXd noise_variance = noise_.cwiseAbs2();
  Eigen::MatrixXd v = noise_variance.asDiagonal();
  Eigen::MatrixXd w = (noise_variance / specimens_ + problem_->curvature.cwiseAbs2()).asDiagonal();
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const Eigen::VectorXd change = problem_->changes.col(chosen_[i]);
    v += variances_[i] * change * change.transpose();
    w += (1.0 + variances_[i] / specimens_) * change * change.transpose();
  }
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(v.rows(), v.cols());
  const linalg::CholeskyFactor v_factor(v), w_factor(w);
  v_inverse_ = v_factor.solve(identity);
  w_inverse_ = w_factor.solve(identity);
  v_log_determinant_ = v_factor.log_determinant();
  w_log_determinant_ = w_factor.log_determinant();
}

void LinearExplanation::update_moments() {
  const Eigen::Index m = values_.cols();
  const Eigen::MatrixXd covariance =
      linalg::CholeskyFactor(v_inverse_).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(m, m)));
  Eigen::MatrixXd variance = Eigen::MatrixXd::Zero(m, m);
  for (Eigen::Index s = 0; s < values_.rows(); ++s) {
    const MissingFill filled = fill_missing(problem_->differences.row(s).transpose(), mean_, covariance);
    values_.row(s) = filled.values.transpose();
    variance += filled.variance;
  }
  mean_ = values_.colwise().mean().transpose();
  if (values_.rows() < 2) return;
  const Eigen::MatrixXd centred = values_.rowwise() - mean_.transpose();
  scatter_ = (centred.transpose() * centred + variance) / (specimens_ - 1.0);
}

double LinearExplanation::likelihood() const {
  const double of_means = -0.5 * (w_log_determinant_ + mean_.dot(w_inverse_ * mean_));
  const double of_scatter = -0.5 * (specimens_ - 1.0) * (v_log_determinant_ + v_inverse_.cwiseProduct(scatter_).sum());
  // Once for a level, whatever the number of its outputs.
  double of_noise = 0.0;
  std::vector<double> seen;
  for (Eigen::Index k = 0; k < noise_.size(); ++k) {
    if (std::ranges::count(seen, problem_->typical_noise(k)) > 0) continue;
    seen.push_back(problem_->typical_noise(k));
    const double distance = std::log(noise_(k) / problem_->typical_noise(k)) / k_noise_log_std;
    of_noise -= 0.5 * distance * distance;
  }
  return of_means + of_scatter + of_noise;
}

double LinearExplanation::value() const {
  double sum = likelihood();
  for (const Eigen::Index number : chosen_) sum += problem_->preferences(number);
  return sum;
}

LinearExplanation::Gain LinearExplanation::gain(Eigen::Index number) const {
  static const std::vector<double> k_tried = tried_variances();
  const Eigen::VectorXd change = problem_->changes.col(number);
  const Eigen::VectorXd v_change = v_inverse_ * change;
  const Eigen::VectorXd w_change = w_inverse_ * change;
  // The determinants and inverses of matrices of rank 1 more, by Sherman and Morrison.
  const double u = change.dot(v_change);
  const double t = v_change.dot(scatter_ * v_change);
  const double v = change.dot(w_change);
  const double w = mean_.dot(w_change);
  Gain best{-std::numeric_limits<double>::infinity(), 0.0};
  for (const double variance : k_tried) {
    if (variance > 0.0 && specimens_ < 2.0) break;
    const double wide = 1.0 + variance / specimens_;
    const double of_scatter =
        0.5 * (specimens_ - 1.0) * (variance * t / (1.0 + variance * u) - std::log1p(variance * u));
    const double of_means = 0.5 * (wide * w * w / (1.0 + wide * v) - std::log1p(wide * v));
    if (of_scatter + of_means > best.value) best = {of_scatter + of_means, variance};
  }
  best.value += problem_->preferences(number);
  return best;
}

void LinearExplanation::add(Eigen::Index number, double variance) {
  chosen_.push_back(number);
  variances_.push_back(variance);
  update_factors();
}

void LinearExplanation::remove(Eigen::Index number) {
  const auto place = std::ranges::find(chosen_, number) - chosen_.begin();
  chosen_.erase(chosen_.begin() + place);
  variances_.erase(variances_.begin() + place);
  update_factors();
}

void LinearExplanation::estimate_noise() {
  constexpr std::array k_factors{0.5, 0.8, 0.95, 1.05, 1.25, 2.0};
  std::vector<double> levels(problem_->typical_noise.begin(), problem_->typical_noise.end());
  std::ranges::sort(levels);
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  for (const double level : levels) {
    const Eigen::VectorXd start = noise_;
    Eigen::VectorXd best = noise_;
    double highest = likelihood();
    for (const double factor : k_factors) {
      noise_ = (problem_->typical_noise.array() == level).select(factor * start, start);
      update_factors();
      const double there = likelihood();
      if (there > highest) best = noise_;
      highest = std::max(highest, there);
    }
    noise_ = best;
    update_factors();
  }
}

void LinearExplanation::estimate(int sweeps) {
  const bool has_gaps = !problem_->differences.allFinite();
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const Eigen::Index number : std::vector<Eigen::Index>(chosen_)) {
      remove(number);
      add(number, gain(number).variance);
    }
    estimate_noise();
    if (has_gaps) update_moments();
  }
}

Eigen::VectorXd LinearExplanation::expected_mean() const {
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(problem_->changes.cols());
  for (const Eigen::Index number : chosen_) {
    expected(number) = problem_->changes.col(number).dot(w_inverse_ * mean_);
  }
  return expected;
}

}  // namespace mottle::study
