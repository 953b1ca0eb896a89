// Mode shapes whose size tests do not give, compared by direction.
#pragma once

#include "model/responses/mode_shapes.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

/// Components of each shape phi, of tests and of the model alike, scaled so that all have the same projection on the
/// reference's shape r over the translations (over rotations where there are no others):
///   y = c phi,  c = (r' W r) / (r' W phi),  W = diag(1: takes part, 0: does not).
/// y is the same for every size and sign of phi, and different for every direction. As r' W y = r' W r, one component
/// follows from the others; that of the largest |r| is no output. Directions whose MAC with r is below 0.1 have none.
class ShapeDirections final : public Response {
 public:
  explicit ShapeDirections(ModeShapes shapes) : shapes_(std::move(shapes)) {}

  ResponseNeeds needs() const override { return shapes_.needs(); }
  /// @throws InvalidInput  there is one degree of freedom only, or the reference's shape is zero at those that take
  /// part
  void take_reference(const Eigen::MatrixXd& shapes) override;
  std::vector<Quantity> quantities() const override;
  std::vector<Quantity> measured() const override { return shapes_.quantities(); }
  /// nan of a mode that misses one of the components by which it is scaled, is zero, or is too unlike the reference.
  Eigen::RowVectorXd outputs_of(const Eigen::RowVectorXd& measured) const override;
  std::string fill(const NumberedSolution& solution, Row row) const override;
  Eigen::MatrixXd derivatives(const SolvedPoint& point) const override;

 private:
  /// c; nan: there is none.
  double factor(const Eigen::VectorXd& shape, Eigen::Index k) const;
  /// Of one of the modes: its part of the outputs.
  Eigen::VectorXd without_dropped(const Eigen::VectorXd& shape, std::size_t k) const;

  ModeShapes shapes_;
  Eigen::VectorXd weights_;            // diagonal of W [degree of freedom]
  Eigen::MatrixXd reference_;          // W r [degree of freedom x mode of the outputs]
  std::vector<Eigen::Index> dropped_;  // degree of freedom that is no output, by mode of the outputs
};

}  // namespace mottle::model
