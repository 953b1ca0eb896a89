#include "mottle/model/eigenvalue_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "model/parameter_pencils.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"

namespace mottle::model {
namespace {

/// PencilCoefficients of one pencil.
struct PencilCoefficients {
  Eigen::VectorXd stiffness, mass;
};

/// The least and the greatest product of powers in a box of positive numbers.
double extreme_product(const Eigen::Ref<const Eigen::RowVectorXi>& powers, const ParameterBox& box, bool is_greatest) {
  double product = 1.0;
  for (Eigen::Index i = 0; i < powers.size(); ++i) {
    if (powers(i) == 0) continue;
    product *= std::pow((powers(i) > 0) == is_greatest ? box.upper(i) : box.lower(i), powers(i));
  }
  return product;
}

/// Powers [term x parameter] less what all terms of K and M are divided by [parameter].
Eigen::VectorXd extreme_products(const Eigen::MatrixXi& powers, const Eigen::RowVectorXi& common,
                                 const ParameterBox& box, bool is_greatest) {
  Eigen::VectorXd products(powers.rows());
  for (Eigen::Index t = 0; t < powers.rows(); ++t) {
    products(t) = extreme_product(powers.row(t) - common, box, is_greatest);
  }
  return products;
}

/// The pencil whose eigenvalues no pencil of the box falls below, or exceeds.
PencilCoefficients bounding(const ParameterPencils& family, const Eigen::RowVectorXi& common, const ParameterBox& box,
                            bool is_upper) {
  return {extreme_products(family.stiffness_powers(), common, box, is_upper),
          extreme_products(family.mass_powers(), common, box, !is_upper)};
}

PencilCoefficients at_point(const ParameterPencils& family, const Eigen::VectorXd& x) {
  return bounding(family, Eigen::RowVectorXi::Zero(x.size()), {x, x}, false);
}

EigenvalueTrend trend_of(const ParameterPencils& family, Eigen::Index parameter) {
  const auto& stiffness = family.stiffness_powers().col(parameter);
  const auto& mass = family.mass_powers().col(parameter);
  if (stiffness.minCoeff() >= mass.maxCoeff()) return EigenvalueTrend::rising;
  if (stiffness.maxCoeff() <= mass.minCoeff()) return EigenvalueTrend::falling;
  return EigenvalueTrend::mixed;
}

/// A part of the box, by the mixed parameters, and what is proven there [mode].
struct BoxPart {
  ParameterBox box;
  Eigen::VectorXd lower, upper;
};

/// Divides a box until proven and attained ends agree.
class EigenvalueRangeSearch {
 public:
  EigenvalueRangeSearch(const ParameterPencils& family, const std::vector<EigenvalueTrend>& trends,
                        const ParameterBox& box, int modes, const EigenvalueBoundsOptions& options,
                        const RunContext& context)
      : family_(family), trends_(trends), modes_(modes), options_(options), context_(context) {
    const double infinity = std::numeric_limits<double>::infinity();
    const Eigen::Index q = box.lower.size();
    found_.proven_lower = found_.attained_lower = Eigen::VectorXd::Constant(modes, infinity);
    found_.proven_upper = found_.attained_upper = Eigen::VectorXd::Constant(modes, -infinity);
    found_.at_lower = found_.at_upper = Eigen::MatrixXd::Zero(modes, q);
    common_ = Eigen::RowVectorXi::Zero(q);
    for (Eigen::Index i = 0; i < q; ++i) {
      if (trends_[static_cast<std::size_t>(i)] == EigenvalueTrend::mixed && box.lower(i) < box.upper(i)) {
        mixed_.push_back(i);
      }
    }
  }

  EigenvalueRanges run(const ParameterBox& box) {
    choose_common_powers(box);
    attain_corners(box);
    std::vector<BoxPart> open = examine({{box, {}, {}}});
    while (!open.empty()) {
      context_.throw_if_stopped();
      std::vector<BoxPart> children;
      for (const BoxPart& part : open) divide(part, children);
      const auto cost = static_cast<std::int64_t>(4 * children.size());
      if (found_.solutions + cost > options_.max_solutions) {
        found_.reaches_tolerance = false;
        for (const BoxPart& part : open) close(part);
        break;
      }
      open = examine(std::move(children));
    }
    return std::move(found_);
  }

 private:
  /// The box with its monotone parameters on the side where eigenvalues are lowest, or highest.
  ParameterBox side_of(ParameterBox box, bool is_upper) const {
    for (std::size_t k = 0; k < trends_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      if (trends_[k] == EigenvalueTrend::mixed) continue;
      const bool is_at_upper = (trends_[k] == EigenvalueTrend::rising) == is_upper;
      (is_at_upper ? box.lower(i) : box.upper(i)) = is_at_upper ? box.upper(i) : box.lower(i);
    }
    return box;
  }

  std::vector<PencilEigenvalues> solve(const std::vector<PencilCoefficients>& pencils) {
    std::vector<PencilEigenvalues> solved(pencils.size());
    parallel_for(static_cast<std::int64_t>(pencils.size()), 1, context_.threads,
                 [&](std::int64_t begin, std::int64_t end) {
                   for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
                     solved[k] = family_.solve(pencils[k].stiffness, pencils[k].mass, modes_);
                   }
                 });
    found_.solutions += static_cast<std::int64_t>(pencils.size());
    for (const PencilEigenvalues& one : solved) {
      if (!one.values.allFinite()) {
        throw ModelFailure("the structure has no modes somewhere in the box of the parameters: there is no range");
      }
    }
    return solved;
  }

  void attain(const PencilEigenvalues& solved, const Eigen::VectorXd& x) {
    for (Eigen::Index k = 0; k < modes_; ++k) {
      if (solved.values(k) < found_.attained_lower(k)) {
        found_.attained_lower(k) = solved.values(k);
        found_.at_lower.row(k) = x.transpose();
      }
      if (solved.values(k) > found_.attained_upper(k)) {
        found_.attained_upper(k) = solved.values(k);
        found_.at_upper.row(k) = x.transpose();
      }
    }
  }

  /// Extremes often lie in corners, which no middle of a part reaches.
  void attain_corners(const ParameterBox& box) {
    constexpr std::size_t k_most = 6;
    const std::size_t count = std::size_t{1} << std::min(mixed_.size(), k_most);
    std::vector<Eigen::VectorXd> points;
    std::vector<PencilCoefficients> pencils;
    for (std::size_t corner = 0; corner < count; ++corner) {
      for (const bool is_upper : {false, true}) {
        Eigen::VectorXd x = side_of(box, is_upper).lower;
        for (std::size_t m = 0; m < mixed_.size(); ++m) {
          const bool is_high = m < k_most && ((corner >> m) & 1U) != 0;
          x(mixed_[m]) = is_high ? box.upper(mixed_[m]) : box.lower(mixed_[m]);
        }
        points.push_back(x);
        pencils.push_back(at_point(family_, x));
      }
    }
    const std::vector<PencilEigenvalues> solved = solve(pencils);
    for (std::size_t k = 0; k < points.size(); ++k) attain(solved[k], points[k]);
  }

  /// Of each mixed parameter the power whose removal from all terms brings the ends of the whole box nearest.
  void choose_common_powers(const ParameterBox& box) {
    const auto gap_of = [&](const Eigen::RowVectorXi& common) {
      const auto ends = solve(
          {bounding(family_, common, side_of(box, false), false), bounding(family_, common, side_of(box, true), true)});
      return (ends[1].values - ends[0].values).cwiseQuotient(ends[1].values).sum();
    };
    for (const Eigen::Index i : mixed_) {
      std::set<int> powers{0};
      for (const auto* table : {&family_.stiffness_powers(), &family_.mass_powers()}) {
        for (Eigen::Index t = 0; t < table->rows(); ++t) powers.insert((*table)(t, i));
      }
      double least = std::numeric_limits<double>::infinity();
      int best = 0;
      for (const int power : powers) {
        common_(i) = power;
        const double gap = gap_of(common_);
        if (gap < least) best = power;
        least = std::min(least, gap);
      }
      common_(i) = best;
    }
  }

  /// Bounds the parts and attains their middles; returns those that are not yet within the tolerance.
  std::vector<BoxPart> examine(std::vector<BoxPart> parts) {
    std::vector<PencilCoefficients> pencils;
    for (const BoxPart& part : parts) {
      for (const bool is_upper : {false, true}) {
        const ParameterBox side = side_of(part.box, is_upper);
        pencils.push_back(bounding(family_, common_, side, is_upper));
        if (!mixed_.empty()) pencils.push_back(at_point(family_, side.middle()));
      }
    }
    const std::vector<PencilEigenvalues> solved = solve(pencils);
    const std::size_t step = mixed_.empty() ? 1 : 2;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const PencilEigenvalues& low = solved[2 * step * p];
      const PencilEigenvalues& high = solved[2 * step * p + step];
      parts[p].lower = low.values - low.errors;
      parts[p].upper = high.values + high.errors;
      if (mixed_.empty()) continue;
      attain(solved[2 * step * p + 1], side_of(parts[p].box, false).middle());
      attain(solved[2 * step * p + step + 1], side_of(parts[p].box, true).middle());
    }
    std::vector<BoxPart> open;
    for (BoxPart& part : parts) {
      if (mixed_.empty() || is_settled(part)) {
        close(part);
      } else {
        open.push_back(std::move(part));
      }
    }
    return open;
  }

  bool is_settled(const BoxPart& part) const {
    constexpr double k_of_highest = 1e-6;  // rigid-body motions have no digits of their own
    const double floor = k_of_highest * std::abs(found_.attained_upper(modes_ - 1));
    const auto near = [&](double apart, double value) {
      return apart <= options_.tolerance * std::max(std::abs(value), floor);
    };
    for (Eigen::Index k = 0; k < modes_; ++k) {
      if (!near(found_.attained_lower(k) - part.lower(k), found_.attained_lower(k))) return false;
      if (!near(part.upper(k) - found_.attained_upper(k), found_.attained_upper(k))) return false;
    }
    return true;
  }

  void close(const BoxPart& part) {
    found_.proven_lower = found_.proven_lower.cwiseMin(part.lower);
    found_.proven_upper = found_.proven_upper.cwiseMax(part.upper);
  }

  /// In two at the geometric middle of the parameter that moves the coefficients most.
  void divide(const BoxPart& part, std::vector<BoxPart>& children) const {
    Eigen::Index widest = mixed_.front();
    double most = -1.0;
    for (const Eigen::Index i : mixed_) {
      const int power = std::max((family_.stiffness_powers().col(i).array() - common_(i)).abs().maxCoeff(),
                                 (family_.mass_powers().col(i).array() - common_(i)).abs().maxCoeff());
      const double effect = power * std::log(part.box.upper(i) / part.box.lower(i));
      if (effect > most) widest = i;
      most = std::max(most, effect);
    }
    const double middle = std::sqrt(part.box.lower(widest) * part.box.upper(widest));
    for (const bool is_upper : {false, true}) {
      children.push_back({part.box, {}, {}});
      (is_upper ? children.back().box.lower : children.back().box.upper)(widest) = middle;
    }
  }

  const ParameterPencils& family_;
  const std::vector<EigenvalueTrend>& trends_;
  int modes_;
  const EigenvalueBoundsOptions& options_;
  const RunContext& context_;
  std::vector<Eigen::Index> mixed_;
  Eigen::RowVectorXi common_;
  EigenvalueRanges found_;
};

}  // namespace

EigenvalueBounds::EigenvalueBounds(const StructureModel& model) : pencils_(make_parameter_pencils(model.structure())) {
  if (pencils_ == nullptr) {
    obstacle_ = "its matrices are not known as sums of powers of the parameters";
  } else if (!pencils_->indefinite_term().empty()) {
    obstacle_ = "a term of " + pencils_->indefinite_term() + " is not positive semidefinite";
  } else {
    for (Eigen::Index i = 0; i < model.parameter_count(); ++i) trends_.push_back(trend_of(*pencils_, i));
  }
}

EigenvalueBounds::~EigenvalueBounds() = default;
EigenvalueBounds::EigenvalueBounds(EigenvalueBounds&&) noexcept = default;

EigenvalueRanges EigenvalueBounds::over(const ParameterBox& box, int modes, const EigenvalueBoundsOptions& options,
                                        const RunContext& context) const {
  require(obstacle_.empty(), "no range of eigenvalues can be proven: {}", obstacle_);
  require((box.lower.array() > 0.0).all() && (box.lower.array() <= box.upper.array()).all(),
          "the box of the parameters must have positive ends, the lower not above the upper");
  return EigenvalueRangeSearch(*pencils_, trends_, box, modes, options, context).run(box);
}

Eigen::MatrixXd EigenvalueBounds::at(const Eigen::Ref<const Eigen::MatrixXd>& points, int modes,
                                     const RunContext& context) const {
  require(obstacle_.empty(), "no range of eigenvalues can be proven: {}", obstacle_);
  Eigen::MatrixXd values(points.rows(), modes);
  parallel_for(points.rows(), 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (Eigen::Index s = begin; s < end; ++s) {
      const PencilCoefficients pencil = at_point(*pencils_, points.row(s).transpose());
      values.row(s) = pencils_->solve(pencil.stiffness, pencil.mass, modes).values.transpose();
    }
  });
  return values;
}

}  // namespace mottle::model
