// What a method finds of the parameters, whatever form it has: it can draw, and has moments, marginal densities and
// quantiles, and regions of pairs. Clouds, predictions, verdict, files and page know only this.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::updating {

struct PopulationOnScales;

/// What the scatter of an estimate is of.
enum class EstimateKind {
  population,  ///< the specimens' parameters, from one to the next
  mean,        ///< what is not known of the parameters of one structure, or of the mean of many
  posterior,   ///< the same as samples of its distribution
  box,         ///< none: the parameters lie between bounds, and nothing is known of how
};

/// "population", "mean", "posterior", "box".
std::string estimate_kind_text(EstimateKind kind);

/// How the parameters of new specimens are drawn for a prediction.
struct SpecimenDrawing {
  enum class Kind {
    population,  ///< the estimate taken as exact
    outputs,     ///< each output by itself: one scale of the whole scatter is uncertain
    joint,       ///< all outputs together: the whole covariance is uncertain
  };

  Kind kind = Kind::population;
  Eigen::Index draws = 0;
  std::uint64_t seed = 0;
  bool has_model_error = false;     ///< the part of the mean's uncertainty that all specimens share is in `mean_shift`
  Eigen::MatrixXd mean_shift = {};  ///< of the mean on the scales, in every draw; empty: none [draw x parameter]
};

class Estimate {
 public:
  virtual ~Estimate() = default;

  virtual EstimateKind kind() const = 0;
  /// Of the parameters on their own axes [parameter], [parameter x parameter].
  virtual Eigen::VectorXd mean() const = 0;
  virtual Eigen::MatrixXd covariance() const = 0;
  /// What the parameters' bounds hold for [parameter]: the mean, but of a population that is normal on other scales the
  /// variables at its mean there, which are their medians. The mean of such a variable may lie beyond its bound.
  virtual Eigen::VectorXd location() const { return mean(); }
  Eigen::Index parameter_count() const { return mean().size(); }

  /// Samples from uniforms, row by row [sample x parameter]. What is physically impossible is left to
  /// ParameterSpace::draw.
  ///
  /// @param uniforms  in (0, 1), as of a sampling design [sample x parameter]
  virtual Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const = 0;

  /// Marginal density of a parameter at each of `points`, 0 outside its support.
  virtual Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const = 0;
  /// Where a curve of that density is drawn: `count` ascending points; empty where it has no width.
  virtual Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const = 0;
  /// Value that the parameter stays below with `probability` in (0, 1).
  virtual double quantile(Eigen::Index parameter, double probability) const = 0;

  /// Closed outlines [point x 2], the first point repeated at the end, of a region that two parameters are in with
  /// `probability` in (0, 1); none where it has no area.
  ///
  /// @param points  of each outline, >= 4
  virtual std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                              Eigen::Index points) const = 0;

  /// Correlations on the scales on which the estimate has its natural form [parameter x parameter]; nan: no scatter.
  virtual Eigen::MatrixXd correlation() const;

  /// Parameters of new specimens for a prediction [draw x parameter]. Here: draws of the estimate, which hold all
  /// that is not known.
  virtual Eigen::MatrixXd draw_specimens(const SpecimenDrawing& drawing) const;
  /// Specimens whose number limits what is known of the scatter; 0: the estimate is taken as it stands.
  virtual Eigen::Index specimens() const { return 0; }
  /// Whether enough is known for a region of all outputs together.
  virtual bool has_joint_region() const { return true; }
  /// A sentence on what predicted intervals leave out; empty: nothing.
  virtual std::string prediction_note() const { return {}; }

  /// The normal population on the parameters' scales, of estimates that are one; else null.
  virtual const PopulationOnScales* population() const { return nullptr; }
  /// Logarithm of the evidence, the probability density of the tests under the model, of methods that find it.
  virtual std::optional<double> log_evidence() const { return std::nullopt; }
  /// Number of independent samples that the estimate is worth; nothing where it is no sample.
  virtual std::optional<double> effective_samples() const { return std::nullopt; }
};

}  // namespace mottle::updating
