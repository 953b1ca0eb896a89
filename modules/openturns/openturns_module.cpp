// Sobol's sequence and the surrogates of OpenTURNS, whose errors end here: none of its types leaves the module.
#include <openturns/ComposedDistribution.hxx>
#include <openturns/ConstantBasisFactory.hxx>
#include <openturns/CorrectedLeaveOneOut.hxx>
#include <openturns/Exception.hxx>
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
#include <openturns/SobolSequence.hxx>
#include <openturns/TBB.hxx>
#include <openturns/Uniform.hxx>
#include <utility>
#include <vector>

#include "mottle/core/error.hpp"
#include "stats/openturns/openturns.hpp"

namespace mottle::stats {
namespace {

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

/// One function of OpenTURNS an output.
class FunctionFit : public Surrogate::Fit {
 public:
  Eigen::MatrixXd at(const Eigen::MatrixXd& x) const override {
    Eigen::MatrixXd y(x.rows(), static_cast<Eigen::Index>(functions_.size()));
    try {
      const OT::Sample points = to_sample(x);
      for (std::size_t k = 0; k < functions_.size(); ++k) {
        y.col(static_cast<Eigen::Index>(k)) = first_column(functions_[k](points));
      }
    } catch (const OT::Exception& error) {
      throw SystemFailure(fmt::format("the surrogate cannot be evaluated: {}", error.what()));
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

[[noreturn]] void throw_fit_failure(const Eigen::MatrixXd& x, const OT::Exception& error) {
  throw SystemFailure(fmt::format("the surrogate cannot be fitted to {} runs: {}", x.rows(), error.what()));
}

class OpenTurnsModule final : public OpenTurns {
 public:
  OpenTurnsModule() { OT::Log::Show(OT::Log::NONE); }  // it remarks on every covariance length's limits

  Eigen::Index max_sobol_dimension() const override {
    return static_cast<Eigen::Index>(OT::SobolSequence::MaximumDimension);
  }

  void fill_with_sobol_points(Eigen::Ref<Eigen::MatrixXd> points) const override {
    const OT::SobolSequence sequence(static_cast<OT::UnsignedInteger>(points.cols()));
    for (Eigen::Index s = 0; s < points.rows(); ++s) {
      const OT::Point point = sequence.generate();
      for (Eigen::Index j = 0; j < points.cols(); ++j) points(s, j) = point[static_cast<OT::UnsignedInteger>(j)];
    }
  }

  std::shared_ptr<const Surrogate::Fit> kriging(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                                                const Surrogate::Fit* like) const override {
    try {
      return std::make_shared<KrigingFit>(x, y, dynamic_cast<const KrigingFit*>(like));
    } catch (const OT::Exception& error) {
      throw_fit_failure(x, error);
    }
  }

  std::shared_ptr<const Surrogate::Fit> chaos(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) const override {
    try {
      return std::make_shared<ChaosFit>(x, y);
    } catch (const OT::Exception& error) {
      throw_fit_failure(x, error);
    }
  }
};

}  // namespace
}  // namespace mottle::stats

extern "C" {
// The names that stats/openturns/load_openturns.cpp looks for.
// NOLINTNEXTLINE(readability-identifier-naming): a name of C
__attribute__((visibility("default"))) extern const int mottle_openturns_version;
const int mottle_openturns_version = mottle::stats::k_openturns_version;
__attribute__((visibility("default"))) const mottle::stats::OpenTurns* mottle_openturns();
const mottle::stats::OpenTurns* mottle_openturns() {
  static const mottle::stats::OpenTurnsModule module;
  OT::TBB::Disable();  // its threads would not be there in a forked process
  return &module;
}
}
