#include "mottle/drivers/calculix/separable_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mottle/core/error.hpp"

namespace mottle::drivers {
namespace {

constexpr double k_agreement = 1e-8;
constexpr double k_rounding = 1e-12;  // of what files of 14 digits leave in a difference of matrices

/// Powers of x / nominal by which a parameter enters, and its interpolation nodes besides 1.
struct Powers {
  std::vector<int> exponents;
  std::vector<double> nodes;
};

const std::vector<Powers>& ladder() {
  static const std::vector<Powers> k_ladder = {
      {{0, 1}, {1.5}}, {{-1, 0, 1}, {1.5, 0.7}}, {{-1, 0, 1, 2, 3}, {1.5, 0.7, 1.25, 0.85}}};
  return k_ladder;
}

/// A point of the interpolation grid: node of each parameter, 0 for the nominal one.
using Point = std::map<int, int>;

/// Values of K behind those of M, in the patterns of the nominal run.
using Values = Eigen::VectorXd;

class Fit {
 public:
  Fit(const std::vector<FitAxis>& axes, const std::function<MatrixRun(const Eigen::VectorXd&)>& run)
      : axes_(axes), run_(run), steps_(axes.size(), 0) {
    for (std::size_t i = 0; i < axes.size(); ++i) steps_[i] = axes[i].is_thickness ? 1 : 0;
  }

  SeparableFit find() {
    nominal_ = run_(values_at(Eigen::VectorXd::Ones(count())));
    runs_ = 1;
    require(nominal_.stiffness.names == nominal_.mass.names &&
                nominal_.stiffness.lower.rows() == nominal_.mass.lower.rows(),
            "stiffness and mass have different rows");
    matrices_[{}] = packed(nominal_);
    const Eigen::VectorXd elsewhere = verification_point();
    const Values there = ask(elsewhere);
    SeparableFit fit = assemble(elsewhere, there);
    if (fit.error > k_agreement) {
      for (int i = 0; i < static_cast<int>(count()); ++i) find_powers(i);
      fit = assemble(elsewhere, there);
    }
    if (fit.error > k_agreement) {
      find_pairs();
      fit = assemble(elsewhere, there);
    }
    if (fit.error > k_agreement) {
      throw NotSeparable(fmt::format(
          "with all parameters moved at once, the matrices are {:.1e} of their diagonal off the best sum of "
          "products of two parameters' powers",
          fit.error));
    }
    return fit;
  }

 private:
  Eigen::Index count() const { return static_cast<Eigen::Index>(axes_.size()); }
  const Powers& powers(int axis) const {
    return ladder()[static_cast<std::size_t>(steps_[static_cast<std::size_t>(axis)])];
  }

  Eigen::VectorXd values_at(const Eigen::VectorXd& scaled) const {
    Eigen::VectorXd values = scaled;
    for (Eigen::Index i = 0; i < count(); ++i) values(i) *= axes_[static_cast<std::size_t>(i)].nominal;
    return values;
  }

  /// All parameters moved, each differently; the same at every call, so that a second command asks for the same run.
  Eigen::VectorXd verification_point() const {
    constexpr double k_golden = 0.6180339887498949;
    Eigen::VectorXd scaled(count());
    for (Eigen::Index i = 0; i < count(); ++i) {
      const double turn = static_cast<double>(i + 1) * k_golden;
      scaled(i) = 0.75 + 0.5 * (turn - std::floor(turn));
    }
    return scaled;
  }

  Values packed(const MatrixRun& run) const {
    const auto& k = run.stiffness.lower;
    const auto& m = run.mass.lower;
    Values values(k.nonZeros() + m.nonZeros());
    values << k.coeffs().matrix(), m.coeffs().matrix();
    return values;
  }

  static bool have_one_pattern(const SymmetricMatrix& a, const SymmetricMatrix& b) {
    const auto nonzeros = static_cast<std::size_t>(a.lower.nonZeros());
    return a.names == b.names && a.lower.rows() == b.lower.rows() && a.lower.nonZeros() == b.lower.nonZeros() &&
           std::equal(a.lower.outerIndexPtr(), a.lower.outerIndexPtr() + a.lower.rows() + 1, b.lower.outerIndexPtr()) &&
           std::equal(a.lower.innerIndexPtr(), a.lower.innerIndexPtr() + nonzeros, b.lower.innerIndexPtr());
  }

  Values ask(const Eigen::VectorXd& scaled) {
    const MatrixRun run = run_(values_at(scaled));
    ++runs_;
    if (!have_one_pattern(run.stiffness, nominal_.stiffness) || !have_one_pattern(run.mass, nominal_.mass)) {
      throw NotSeparable("the rows or entries of the solver's matrices change with the parameters");
    }
    return packed(run);
  }

  /// The difference products of a point: the alternating sum over the points below it.
  const Values& matrix(const Point& point) {
    const auto found = matrices_.find(point);
    if (found != matrices_.end()) return found->second;
    Eigen::VectorXd scaled = Eigen::VectorXd::Ones(count());
    for (const auto& [axis, node] : point) scaled(axis) = powers(axis).nodes[static_cast<std::size_t>(node)];
    return matrices_.emplace(point, ask(scaled)).first->second;
  }

  Values surplus(const Point& point) {
    Values values = matrix(point) - matrix({});
    if (point.size() == 2) {
      values -= matrix({*point.begin()}) - matrix({});
      values -= matrix({*point.rbegin()}) - matrix({});
    }
    return values;
  }

  /// Coefficients of the Lagrange function of a node, by exponent; it is 1 there and 0 at the nominal and other nodes.
  Eigen::VectorXd lagrange(int axis, int node) const {
    const Powers& of = powers(axis);
    const auto size = static_cast<Eigen::Index>(of.exponents.size());
    Eigen::MatrixXd vandermonde(size, size);
    for (Eigen::Index row = 0; row < size; ++row) {
      const double x = row == 0 ? 1.0 : of.nodes[static_cast<std::size_t>(row) - 1];
      for (Eigen::Index e = 0; e < size; ++e) {
        vandermonde(row, e) = std::pow(x, of.exponents[static_cast<std::size_t>(e)]);
      }
    }
    return vandermonde.partialPivLu().solve(Eigen::VectorXd::Unit(size, node + 1));
  }

  using PolynomialTerms = std::map<std::vector<ParameterPower>, Values>;

  void add_product(PolynomialTerms& terms, const Point& point, const Values& surplus_values) const {
    std::vector<std::pair<std::vector<ParameterPower>, double>> product = {{{}, 1.0}};
    for (const auto& [axis, node] : point) {
      const Eigen::VectorXd factors = lagrange(axis, node);
      std::vector<std::pair<std::vector<ParameterPower>, double>> longer;
      for (const auto& [coefficient, value] : product) {
        for (std::size_t e = 0; e < powers(axis).exponents.size(); ++e) {
          auto powered = coefficient;
          if (powers(axis).exponents[e] != 0) powered.push_back({axis, powers(axis).exponents[e]});
          longer.emplace_back(std::move(powered), value * factors(static_cast<Eigen::Index>(e)));
        }
      }
      product = std::move(longer);
    }
    for (const auto& [coefficient, value] : product) {
      const auto [place, is_new] = terms.try_emplace(coefficient, surplus_values * value);
      if (!is_new) place->second += surplus_values * value;
    }
  }

  PolynomialTerms terms() {
    PolynomialTerms sum;
    sum[{}] = matrix({});
    for (int i = 0; i < static_cast<int>(count()); ++i) {
      for (int k = 0; k < static_cast<int>(powers(i).nodes.size()); ++k) add_product(sum, {{i, k}}, surplus({{i, k}}));
    }
    for (const auto& [i, j] : pairs_) {
      for (int k = 0; k < static_cast<int>(powers(i).nodes.size()); ++k) {
        for (int l = 0; l < static_cast<int>(powers(j).nodes.size()); ++l) {
          const Point point{{i, k}, {j, l}};
          add_product(sum, point, surplus(point));
        }
      }
    }
    return sum;
  }

  /// sqrt(A_aa A_bb) of each entry, by which its error is measured.
  Values sizes(const Values& values) const {
    Values result(values.size());
    Eigen::Index place = 0;
    for (const SymmetricMatrix* matrix : {&nominal_.stiffness, &nominal_.mass}) {
      const SparseMatrix& lower = matrix->lower;
      SparseMatrix filled = lower;
      filled.coeffs() = values.segment(place, lower.nonZeros()).array();
      Eigen::VectorXd diagonal = filled.diagonal().cwiseAbs();
      diagonal = diagonal.cwiseMax(k_rounding * diagonal.maxCoeff());
      for (int j = 0; j < lower.outerSize(); ++j) {
        for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
          result(place++) = std::sqrt(diagonal(entry.row()) * diagonal(j));
        }
      }
    }
    return result;
  }

  double difference(const Values& a, const Values& b) const {
    return ((a - b).cwiseAbs().array() / sizes(b).array()).maxCoeff();
  }

  Values evaluate(const PolynomialTerms& sum, const Eigen::VectorXd& scaled) const {
    Values result = Values::Zero(sum.begin()->second.size());
    for (const auto& [coefficient, values] : sum) {
      double factor = 1.0;
      for (const ParameterPower& power : coefficient) factor *= std::pow(scaled(power.parameter), power.power);
      result += factor * values;
    }
    return result;
  }

  SeparableFit assemble(const Eigen::VectorXd& elsewhere, const Values& there) {
    PolynomialTerms sum = terms();
    const Values size = sizes(matrix({}));
    for (auto& [coefficient, values] : sum) {
      values = (values.array().abs() <= k_rounding * size.array()).select(0.0, values);
    }
    SeparableFit fit;
    fit.error = difference(evaluate(sum, elsewhere), there);
    std::vector<ScaledMatrix> stiffness;
    std::vector<ScaledMatrix> mass;
    for (const auto& [coefficient, values] : sum) {
      double scale = 1.0;  // from powers of x / nominal to powers of x
      for (const ParameterPower& power : coefficient) {
        scale *= std::pow(axes_[static_cast<std::size_t>(power.parameter)].nominal, -power.power);
      }
      Eigen::Index place = 0;
      for (auto [matrix, list] : {std::pair{&nominal_.stiffness, &stiffness}, std::pair{&nominal_.mass, &mass}}) {
        SparseMatrix lower = matrix->lower;
        lower.coeffs() = scale * values.segment(place, lower.nonZeros()).array();
        place += lower.nonZeros();
        list->push_back({coefficient, lower.pruned(0.0, 0.0)});
      }
    }
    fit.pencil = make_pencil(stiffness, mass, nominal_.stiffness.names);
    fit.runs = runs_;
    return fit;
  }

  /// Adds powers of the parameter, in the order of the sets above, until its fit holds at one more point.
  void find_powers(int axis) {
    constexpr double k_between = 1.1;
    Eigen::VectorXd scaled = Eigen::VectorXd::Ones(count());
    scaled(axis) = k_between;
    const Values there = ask(scaled);
    int& step = steps_[static_cast<std::size_t>(axis)];
    for (;; ++step) {
      PolynomialTerms sum;
      sum[{}] = matrix({});
      for (int k = 0; k < static_cast<int>(powers(axis).nodes.size()); ++k) {
        add_product(sum, {{axis, k}}, surplus({{axis, k}}));
      }
      if (difference(evaluate(sum, scaled), there) <= k_agreement) return;
      if (step + 1 == static_cast<int>(ladder().size())) {
        throw NotSeparable(fmt::format("parameter '{}': the matrices are no sum of powers of it",
                                       axes_[static_cast<std::size_t>(axis)].name));
      }
    }
  }

  void find_pairs() {
    for (int i = 0; i < static_cast<int>(count()); ++i) {
      for (int j = i + 1; j < static_cast<int>(count()); ++j) {
        const Point both{{i, 0}, {j, 0}};
        const Values alone = matrix({{i, 0}}) + matrix({{j, 0}}) - matrix({});
        if (difference(alone, matrix(both)) > k_agreement) pairs_.emplace_back(i, j);
      }
    }
  }

  const std::vector<FitAxis>& axes_;
  const std::function<MatrixRun(const Eigen::VectorXd&)>& run_;
  std::vector<int> steps_;  // on the ladder, by parameter
  std::vector<std::pair<int, int>> pairs_;
  MatrixRun nominal_;
  std::map<Point, Values> matrices_;
  int runs_ = 0;
};

}  // namespace

SeparableFit fit_separable(const std::vector<FitAxis>& axes,
                           const std::function<MatrixRun(const Eigen::VectorXd&)>& run) {
  return Fit(axes, run).find();
}

}  // namespace mottle::drivers
