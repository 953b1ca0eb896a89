#include "mottle/stats/surrogates/surrogate.hpp"

#include <algorithm>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/process_mutex.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/one_thread.hpp"
#include "stats/openturns/openturns.hpp"
#include "stats/surrogates/surrogate_fit.hpp"

namespace mottle::stats {

namespace {

constexpr Eigen::Index k_folds = 10;

Eigen::Index quadratic_terms(Eigen::Index inputs) {
  return (inputs + 1) * (inputs + 2) / 2;
}

class QuadraticFit final : public Surrogate::Fit {
 public:
  QuadraticFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) : coefficients_(PivotedQr(terms(x)).solve(y)) {}
  Eigen::MatrixXd at(const Eigen::MatrixXd& x) const override { return terms(x) * coefficients_; }

 private:
  static Eigen::MatrixXd terms(const Eigen::MatrixXd& x) {
    Eigen::MatrixXd columns(x.rows(), quadratic_terms(x.cols()));
    columns.leftCols(x.cols() + 1) << Eigen::VectorXd::Ones(x.rows()), x;
    Eigen::Index next = x.cols() + 1;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) columns.col(next++) = x.col(i).cwiseProduct(x.col(j));
    }
    return columns;
  }

  Eigen::MatrixXd coefficients_;
};

std::shared_ptr<const Surrogate::Fit> make_fit(SurrogateKind kind, const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                                               const Surrogate::Fit* whole) {
  if (kind == SurrogateKind::quadratic) return std::make_shared<QuadraticFit>(x, y);
  const NoFork alone;  // since OpenTURNS has locks of its own
  if (kind == SurrogateKind::kriging) return openturns().kriging(x, y, whole);
  return openturns().chaos(x, y);
}

/// Half the range of each column, 1 where it never changes.
Eigen::RowVectorXd half_range(const Eigen::MatrixXd& values) {
  const Eigen::RowVectorXd half = 0.5 * (values.colwise().maxCoeff() - values.colwise().minCoeff());
  return (half.array() > 0.0).select(half, 1.0);
}

}  // namespace

Surrogate::Surrogate(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                     const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  use_one_thread();
  const Eigen::Index runs = inputs.rows();
  require(runs >= min_runs(kind, inputs.cols()), "a surrogate of {} parameters needs at least {} runs, {} are there",
          inputs.cols(), min_runs(kind, inputs.cols()), runs);
  input_scale_ = half_range(inputs);
  input_centre_ = inputs.colwise().minCoeff() + input_scale_;
  output_scale_ = half_range(outputs);
  output_centre_ = outputs.colwise().mean();
  const Eigen::MatrixXd x = scaled(inputs);
  const Eigen::MatrixXd y = (outputs.rowwise() - output_centre_) * output_scale_.cwiseInverse().asDiagonal();
  fit_ = make_fit(kind, x, y, nullptr);
  residuals_.resize(runs, outputs.cols());
  for (Eigen::Index fold = 0; fold < k_folds; ++fold) {
    std::vector<Eigen::Index> kept, left;
    for (Eigen::Index s = 0; s < runs; ++s) (s % k_folds == fold ? left : kept).push_back(s);
    const auto part = make_fit(kind, x(kept, Eigen::all), y(kept, Eigen::all), fit_.get());
    residuals_(left, Eigen::all) = (y(left, Eigen::all) - part->at(x(left, Eigen::all))) * output_scale_.asDiagonal();
  }
}

Eigen::Index Surrogate::min_runs(SurrogateKind kind, Eigen::Index inputs) {
  const Eigen::Index terms = kind == SurrogateKind::quadratic ? quadratic_terms(inputs) : 2 * (inputs + 1);
  return std::max<Eigen::Index>(k_folds, (terms * k_folds + k_folds - 2) / (k_folds - 1));
}

Eigen::MatrixXd Surrogate::scaled(const Eigen::Ref<const Eigen::MatrixXd>& inputs) const {
  return (inputs.rowwise() - input_centre_) * input_scale_.cwiseInverse().asDiagonal();
}

Eigen::MatrixXd Surrogate::operator()(const Eigen::Ref<const Eigen::MatrixXd>& inputs) const {
  if (inputs.rows() == 0) return {0, output_scale_.size()};
  const NoFork alone;
  const Eigen::MatrixXd y = fit_->at(scaled(inputs)) * output_scale_.asDiagonal();
  return y.rowwise() + output_centre_;
}

}  // namespace mottle::stats
