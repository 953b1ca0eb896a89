#include "mottle/stats/surrogates/surrogate.hpp"

#include <algorithm>
#include <openturns/ComposedDistribution.hxx>
#include <openturns/ConstantBasisFactory.hxx>
#include <openturns/CorrectedLeaveOneOut.hxx>
#include <openturns/FixedStrategy.hxx>
#include <openturns/FunctionalChaosAlgorithm.hxx>
#include <openturns/KrigingAlgorithm.hxx>
#include <openturns/LARS.hxx>
#include <openturns/LeastSquaresMetaModelSelectionFactory.hxx>
#include <openturns/LeastSquaresStrategy.hxx>
#include <openturns/LegendreFactory.hxx>
#include <openturns/LinearBasisFactory.hxx>
#include <openturns/LinearEnumerateFunction.hxx>
#include <openturns/Log.hxx>
#include <openturns/MaternModel.hxx>
#include <openturns/OrthogonalProductPolynomialFactory.hxx>
#include <openturns/Uniform.hxx>
#include <utility>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/one_thread.hpp"

namespace mottle::stats {

/// Outputs in scaled units at scaled inputs.
class Surrogate::Fit {
 public:
  virtual ~Fit() = default;
  virtual Eigen::MatrixXd at(const Eigen::MatrixXd& x) const = 0;
};

namespace {

constexpr Eigen::Index k_folds = 10;

Eigen::Index quadratic_terms(Eigen::Index inputs) {
  return (inputs + 1) * (inputs + 2) / 2;
}

OT::Sample to_sample(const Eigen::MatrixXd& values) {
  OT::Sample sample(static_cast<OT::UnsignedInteger>(values.rows()), static_cast<OT::UnsignedInteger>(values.cols()));
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      sample(static_cast<OT::UnsignedInteger>(i), static_cast<OT::UnsignedInteger>(j)) = values(i, j);
    }
  }
  return sample;
}

Eigen::VectorXd first_column(const OT::Sample& sample) {
  Eigen::VectorXd column(static_cast<Eigen::Index>(sample.getSize()));
  for (OT::UnsignedInteger i = 0; i < sample.getSize(); ++i) column(static_cast<Eigen::Index>(i)) = sample(i, 0);
  return column;
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

/// One function of OpenTURNS an output.
class FunctionFit : public Surrogate::Fit {
 public:
  Eigen::MatrixXd at(const Eigen::MatrixXd& x) const override {
    Eigen::MatrixXd y(x.rows(), static_cast<Eigen::Index>(functions_.size()));
    const OT::Sample points = to_sample(x);
    for (std::size_t k = 0; k < functions_.size(); ++k) {
      y.col(static_cast<Eigen::Index>(k)) = first_column(functions_[k](points));
    }
    return y;
  }

 protected:
  void add(OT::Function function) { functions_.push_back(std::move(function)); }

 private:
  std::vector<OT::Function> functions_;
};

class KrigingFit final : public FunctionFit {
 public:
  /// @param like  whose covariance lengths are taken; null: the most likely ones
  KrigingFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, const KrigingFit* like) {
    const auto q = static_cast<OT::UnsignedInteger>(x.cols());
    const bool has_slope = x.rows() >= 3 * (x.cols() + 1);
    const OT::Basis trend = has_slope ? OT::LinearBasisFactory(q).build() : OT::ConstantBasisFactory(q).build();
    const OT::Sample points = to_sample(x);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      const auto index = static_cast<std::size_t>(k);
      OT::MaternModel covariance(like != nullptr ? like->lengths_[index] : OT::Point(q, 1.0), OT::Point(1, 1.0), 2.5);
      covariance.setNuggetFactor(k_nugget);
      OT::KrigingAlgorithm algorithm(points, to_sample(y.col(k)), covariance, trend);
      algorithm.setOptimizationBounds(OT::Interval(OT::Point(q, 0.05), OT::Point(q, 50.0)));  // half ranges
      algorithm.setOptimizeParameters(like == nullptr);
      algorithm.run();
      const OT::KrigingResult result = algorithm.getResult();
      add(result.getMetaModel());
      lengths_.push_back(result.getCovarianceModel().getScale());
    }
  }

 private:
  static constexpr double k_nugget = 1e-10;  // of the variance: keeps the factor of close runs definite
  std::vector<OT::Point> lengths_;
};

class ChaosFit final : public FunctionFit {
 public:
  ChaosFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
    const auto q = static_cast<OT::UnsignedInteger>(x.cols());
    const OT::LinearEnumerateFunction order(q);
    OT::Collection<OT::OrthogonalUniVariatePolynomialFamily> families;
    OT::Collection<OT::Distribution> cube;
    for (OT::UnsignedInteger i = 0; i < q; ++i) {
      families.add(OT::LegendreFactory());
      cube.add(OT::Uniform(-1.0, 1.0));
    }
    const OT::OrthogonalProductPolynomialFactory basis(families, order);
    const auto max_terms = static_cast<OT::UnsignedInteger>(2 * x.rows());
    OT::UnsignedInteger degree = 1;
    while (degree < k_highest_degree && order.getStrataCumulatedCardinal(degree + 1) <= max_terms) ++degree;
    const OT::LeastSquaresMetaModelSelectionFactory selection{OT::LARS(), OT::CorrectedLeaveOneOut()};
    const OT::Sample points = to_sample(x);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      OT::FunctionalChaosAlgorithm algorithm(points, to_sample(y.col(k)), OT::ComposedDistribution(cube),
                                             OT::FixedStrategy(basis, order.getStrataCumulatedCardinal(degree)),
                                             OT::LeastSquaresStrategy(selection));
      algorithm.run();
      add(algorithm.getResult().getMetaModel());
    }
  }

 private:
  static constexpr OT::UnsignedInteger k_highest_degree = 8;
};

std::shared_ptr<const Surrogate::Fit> make_fit(SurrogateKind kind, const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                                               const Surrogate::Fit* whole) {
  try {
    switch (kind) {
      case SurrogateKind::quadratic:
        return std::make_shared<QuadraticFit>(x, y);
      case SurrogateKind::kriging:
        return std::make_shared<KrigingFit>(x, y, dynamic_cast<const KrigingFit*>(whole));
      case SurrogateKind::chaos:
        break;
    }
    return std::make_shared<ChaosFit>(x, y);
  } catch (const OT::Exception& error) {
    throw SystemFailure(fmt::format("the surrogate cannot be fitted to {} runs: {}", x.rows(), error.what()));
  }
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
  OT::Log::Show(OT::Log::NONE);  // it remarks on every covariance length's limits
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
  const Eigen::MatrixXd y = fit_->at(scaled(inputs)) * output_scale_.asDiagonal();
  return y.rowwise() + output_centre_;
}

}  // namespace mottle::stats
