#include "updating/methods/hierarchical_target.hpp"

#include <cmath>
#include <limits>

#include "mottle/core/parallel.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

constexpr std::int64_t k_grain = 16;  // points, some microseconds each

/// One row a specimen: [point x specimen * parameter] -> [point * specimen x parameter].
Eigen::MatrixXd one_below_the_other(const Eigen::MatrixXd& side_by_side, Eigen::Index specimens) {
  const Eigen::Index q = side_by_side.cols() / specimens;
  Eigen::MatrixXd rows(side_by_side.rows() * specimens, q);
  for (Eigen::Index i = 0; i < side_by_side.rows(); ++i) {
    for (Eigen::Index s = 0; s < specimens; ++s) {
      rows.row(i * specimens + s) = side_by_side.row(i).segment(s * q, q);
    }
  }
  return rows;
}

std::shared_ptr<const SampleRegion> region_of(const UpdatingProblem& problem, const Eigen::MatrixXd& points) {
  if (!problem.model.adapts_to_regions()) return nullptr;
  const Eigen::VectorXd mean = points.colwise().mean().transpose();
  const Eigen::MatrixXd apart = points.rowwise() - mean.transpose();
  return region_around(problem, mean, apart.transpose() * apart / static_cast<double>(points.rows()));
}

}  // namespace

SamplingTarget HierarchicalTarget::target() const {
  return {.dimension = prior_.dimension(),
          .log_likelihood = [this](const Eigen::MatrixXd& points) { return log_linear(points); },
          .is_possible = [this](const Eigen::MatrixXd& points) { return prior_.is_possible(points); },
          .before_batch =
              [this](const Eigen::MatrixXd& particles) {
                prior_.require_levels(particles);
                return !context_.stop_requested();
              }};
}

Correction HierarchicalTarget::correction() {
  return {.blocks = static_cast<Eigen::Index>(specimens_.size()),
          .block_size = problem_.space.count() + 1,
          .log_ratio = [this](const Eigen::MatrixXd& points,
                              const Eigen::MatrixXd& auxiliaries) { return log_ratio(points, auxiliaries); },
          .is_possible =
              [this](const Eigen::MatrixXd& points, const Eigen::MatrixXd& auxiliaries) {
                return are_specimens_possible(points, auxiliaries);
              }};
}

/// Within physical limits, as outputs_on_scales() asks for.
Correction::IsPossible HierarchicalTarget::are_specimens_possible(const Eigen::MatrixXd& points,
                                                                  const Eigen::MatrixXd& auxiliaries) const {
  const auto n = static_cast<Eigen::Index>(specimens_.size());
  const Eigen::MatrixXd all = one_below_the_other(specimens(prior_.populations(points), auxiliaries).points, n);
  const Eigen::MatrixXd x = to_variables(problem_.space.transforms(), all);
  Correction::IsPossible possible(points.rows(), n);
  for (Eigen::Index i = 0; i < possible.rows(); ++i) {
    for (Eigen::Index s = 0; s < n; ++s) {
      const Eigen::RowVectorXd specimen = x.row(i * n + s);
      possible(i, s) = specimen.allFinite() && problem_.space.is_possible(specimen);
    }
  }
  return possible;
}

Eigen::VectorXd HierarchicalTarget::log_linear(const Eigen::MatrixXd& points) const {
  Eigen::VectorXd logs = Eigen::VectorXd::Zero(points.rows());
  parallel_for(points.rows(), k_grain, context_.threads, [&](std::int64_t begin, std::int64_t end) {
    const std::vector<PopulationAt> populations = prior_.populations(points.middleRows(begin, end - begin));
    SpecimenAlgebra algebra;
    for (std::int64_t i = begin; i < end; ++i) {
      for (const LinearSpecimen& specimen : specimens_) {
        logs(i) += algebra.condition(specimen, populations[static_cast<std::size_t>(i - begin)]);
      }
    }
  });
  return logs;
}

DrawnSpecimens HierarchicalTarget::specimens(const std::vector<PopulationAt>& populations,
                                             const Eigen::MatrixXd& auxiliaries) const {
  const Eigen::Index q = problem_.space.count();
  const auto n = static_cast<Eigen::Index>(specimens_.size());
  DrawnSpecimens found{Eigen::MatrixXd(auxiliaries.rows(), n * q), Eigen::MatrixXd(auxiliaries.rows(), n)};
  parallel_for(auxiliaries.rows(), k_grain, context_.threads, [&](std::int64_t begin, std::int64_t end) {
    DefensiveDraws draws;
    for (std::int64_t i = begin; i < end; ++i) {
      for (Eigen::Index s = 0; s < n; ++s) {
        const SpecimenDraw drawn =
            draws.draw(specimens_[static_cast<std::size_t>(s)], populations[static_cast<std::size_t>(i)],
                       auxiliaries.row(i).segment(s * (q + 1), q + 1).transpose());
        found.points.row(i).segment(s * q, q) = drawn.parameters.transpose();
        found.log_ratio(i, s) = drawn.log_ratio;
      }
    }
  });
  return found;
}

Eigen::MatrixXd HierarchicalTarget::log_ratio(const Eigen::MatrixXd& points, const Eigen::MatrixXd& auxiliaries) {
  const std::vector<PopulationAt> populations = prior_.populations(points);
  const auto n = static_cast<Eigen::Index>(specimens_.size());
  const DrawnSpecimens drawn = specimens(populations, auxiliaries);
  const Eigen::MatrixXd all = one_below_the_other(drawn.points, n);
  if (!near_) near_ = std::make_unique<const RegionalProblem>(problem_, region_of(problem_, all));
  const Eigen::MatrixXd outputs = outputs_on_scales(near_->problem(), all, context_, evaluations_);
  Eigen::MatrixXd ratio = drawn.log_ratio;
  for (Eigen::Index i = 0; i < ratio.rows(); ++i) {
    for (Eigen::Index s = 0; s < n; ++s) {
      const Eigen::Index row = i * n + s;
      const bool has_failed = !outputs.row(row).allFinite();
      failed_ += has_failed ? 1 : 0;
      ratio(i, s) += has_failed
                         ? -std::numeric_limits<double>::infinity()
                         : log_ratio_to_linear(specimens_[static_cast<std::size_t>(s)],
                                               populations[static_cast<std::size_t>(i)], all.row(row).transpose(),
                                               outputs.row(row).transpose(), problem_.tests.values.row(s).transpose());
    }
  }
  return ratio;
}

Eigen::VectorXd HierarchicalTarget::log_likelihood(const std::vector<PopulationAt>& populations,
                                                   const DrawnSpecimens& drawn,
                                                   const Eigen::MatrixXd& log_ratio) const {
  const Eigen::Index q = problem_.space.count();
  Eigen::VectorXd logs = (log_ratio - drawn.log_ratio).rowwise().sum();
  for (Eigen::Index i = 0; i < logs.size(); ++i) {
    for (std::size_t s = 0; s < specimens_.size(); ++s) {
      logs(i) += log_density_linear(specimens_[s], populations[static_cast<std::size_t>(i)],
                                    drawn.points.row(i).segment(static_cast<Eigen::Index>(s) * q, q).transpose());
    }
  }
  return logs;
}

}  // namespace mottle::updating
