// Interface of the responses, which make outputs of a structure's solution: one class a kind of quantity.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/quantity.hpp"
#include "mottle/model/responses/output_selection.hpp"
#include "mottle/model/solvers/solver.hpp"

namespace mottle::model {

/// Assignment of a sample's modes to those of the reference, with the sign of each shape.
struct ModeMatch {
  std::vector<int> column;   ///< by the reference's mode, counted from 0
  std::vector<double> sign;  ///< the same, of its shape against the reference's
  std::string failure = {};  ///< not empty: a mode is lost, and why
  std::string note = {};     ///< modes that crossed or mixed
};

/// The results that a response needs of every sample's solution.
struct ResponseNeeds {
  std::vector<int> modes = {};               ///< numbers from 1
  std::vector<int> degrees_of_freedom = {};  ///< where it needs displacements
  Eigen::MatrixXd loads = {};                ///< whose static solutions it needs [equation x load]
  bool shapes = false;                       ///< whether modes must be compared with the reference's shapes
  bool damping = false;                      ///< whether it needs damping ratios
};

/// Share of one response in the request: rows of the displacements, and loads.
struct ResponseShare {
  Eigen::Index first_row = 0, rows = 0;
  Eigen::Index first_load = 0;
};

/// The solution of one sample by the numbers and signs of the reference's modes.
class NumberedSolution {
 public:
  /// @param largest  of the reference's eigenvalues
  NumberedSolution(const Solution& solution, const ModeMatch& match, const ResponseShare& share, double largest)
      : solution_(solution), match_(match), share_(share), largest_(largest) {}

  /// Natural frequency in 1 / (time unit of the matrices); nan where the eigenvalue is negative.
  double frequency(int mode) const { return natural_frequency_hz(solution_.eigenvalues(column(mode)), largest_); }
  /// (2 pi f)^2; nan where it is negative.
  double eigenvalue(int mode) const {
    const double speed = 2.0 * std::numbers::pi * frequency(mode);
    return speed * speed;
  }
  double damping_ratio(int mode) const { return solution_.damping_ratios(column(mode)); }
  /// Of the mass-normalised shape, at one of the response's degrees of freedom.
  double displacement(int mode, Eigen::Index k) const {
    return match_.sign[static_cast<std::size_t>(mode - 1)] *
           solution_.displacements(share_.first_row + k, column(mode));
  }
  /// Under one of the response's loads, counted from 0, at one of its degrees of freedom.
  double static_displacement(Eigen::Index load, Eigen::Index k) const {
    return solution_.static_displacements(share_.first_row + k, share_.first_load + load);
  }
  Eigen::Index degrees_of_freedom() const { return share_.rows; }

 private:
  int column(int mode) const { return match_.column[static_cast<std::size_t>(mode - 1)]; }

  const Solution& solution_;
  const ModeMatch& match_;
  const ResponseShare& share_;
  double largest_;
};

/// One point of the parameters with its modes, where derivatives are taken.
struct SolvedPoint {
  const Solver& solver;
  const Eigen::VectorXd& parameters;
  const ModeSet& modes;
  const ModeMatch& match;
  const Eigen::MatrixXd& eigenvalue_derivatives;  ///< [mode as found x parameter]

  int column(int mode) const { return match.column[static_cast<std::size_t>(mode - 1)]; }
};

/// One kind of outputs.
class Response {
 public:
  using Row = Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

  virtual ~Response() = default;

  virtual ResponseNeeds needs() const = 0;
  /// Shapes of the reference at the response's degrees of freedom [degree of freedom x mode 1..highest]; comes before
  /// all of the following.
  virtual void take_reference(const Eigen::MatrixXd& /*shapes*/) {}
  virtual std::vector<Quantity> quantities() const = 0;
  /// What a test must have measured for them.
  virtual std::vector<Quantity> measured() const { return quantities(); }
  /// Row of the quantities from a row of what a test measured; nan: not measured.
  virtual Eigen::RowVectorXd outputs_of(const Eigen::RowVectorXd& measured) const { return measured; }
  /// Fills `row` [quantity] from the solution of one sample.
  ///
  /// @return  why the sample has failed; empty: it has not
  virtual std::string fill(const NumberedSolution& solution, Row row) const = 0;
  /// [quantity x parameter]; nan where there is no analytic derivative.
  virtual Eigen::MatrixXd derivatives(const SolvedPoint& point) const = 0;
};

/// The responses that give the selected outputs, in the outputs' order.
///
/// @throws InvalidInput  an output that the structure does not have (says which it has), a repeated one, none at all
std::vector<std::unique_ptr<Response>> make_responses(const OutputSelection& selection, const Structure& structure);

}  // namespace mottle::model
